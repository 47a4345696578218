#include "core/asset/writer/texture_frames.hpp"

#include <Eigen/Geometry>

#include "core/asset/base/as_size.hpp"
#include "core/asset/gltf/elements.hpp"

namespace unwrapd::asset::writer {
namespace {

using CornerTangents = std::vector<std::array<Tangent, 3>>;

std::optional<std::size_t> attribute(const Gltf& gltf, const Primitive& primitive,
                                     std::string_view name, std::size_t components) {
  for (const auto& [semantic, accessor] : primitive.attributes)
    if (semantic == name && gltf.accessors[accessor].components == components) return accessor;
  return std::nullopt;
}

Vec3 unit(const Vec3& vector) {
  return vector.allFinite() ? vector.stableNormalized().eval() : Vec3::Zero().eval();
}

/// The triangles with three vertices of their own each, without texture coordinates.
TangentMesh soup_of(const Gltf& gltf, const Primitive& primitive,
                    const std::vector<std::array<std::size_t, 3>>& faces) {
  const Elements positions(gltf, primitive.position);
  const auto accessor = attribute(gltf, primitive, "NORMAL", 3);
  const std::optional<Elements> normals =
      accessor ? std::optional<Elements>(std::in_place, gltf, *accessor) : std::nullopt;
  TangentMesh soup;
  Pace pace(gltf.stop);
  for (const auto& face : faces) {
    pace.add(8);
    const auto first = static_cast<Index>(soup.positions.size());
    soup.faces.push_back({first, first + 1, first + 2});
    for (const std::size_t vertex : face) soup.positions.push_back(positions.vec3_at(vertex));
    const Vec3* p = &soup.positions[as_size(first)];
    const Vec3 flat = (p[1] - p[0]).cross(p[2] - p[0]);
    for (const std::size_t vertex : face)
      soup.normals.push_back(unit(normals ? normals->vec3_at(vertex) : flat));
  }
  return soup;
}

/// MikkTSpace for the places of the triangles in one of the layouts.
CornerTangents computed(const Gltf& gltf, TangentMesh& soup, const texture::Patch& patch,
                        std::array<Eigen::Vector2f, 3> texture::PlacedTriangle::*layout) {
  soup.uv.clear();
  for (const texture::PlacedTriangle& triangle : patch.triangles)
    for (const Eigen::Vector2f& uv : triangle.*layout)
      soup.uv.emplace_back(double{uv.x()}, 1 - double{uv.y()});
  return corner_tangents(soup, gltf.stop);
}

CornerTangents stored(const Gltf& gltf, std::size_t accessor,
                      const std::vector<std::array<std::size_t, 3>>& faces) {
  const Elements tangents(gltf, accessor);
  CornerTangents corners(faces.size());
  for (std::size_t t = 0; t < faces.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f vector = tangents.vec3_at(faces[t][k]).cast<float>();
      const bool is_mirrored = tangents.fourth_at(faces[t][k]) < 0;
      corners[t][k] = {vector.x(), vector.y(), vector.z(), is_mirrored ? -1.0F : 1.0F};
    }
  return corners;
}

/// The tangent, turned towards the bitangent as the material turns directions of the map.
Eigen::Vector3f axis_of(const Tangent& tangent, const Vec3& normal, double turn) {
  const Vec3 along(tangent[0], tangent[1], tangent[2]);
  const Vec3 across = double{tangent[3]} * normal.cross(along);
  return (std::cos(turn) * along + std::sin(turn) * across).cast<float>();
}

}  // namespace

void add_tangents(const Cut& cut, WrittenTangents& written) {
  if (cut.tangents.empty()) return;
  for (const auto& [piece, corners] : cut.split.corners) {
    CornerTangents& faces = written[piece];
    faces.resize(corners.size() / 3);
    for (std::size_t c = 0; c < 3 * faces.size(); ++c)
      faces[c / 3][c % 3] = cut.tangents[as_size(corners[c])];
  }
}

void set_frames(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped,
                const TextureUse& use, const WrittenTangents& written, texture::Patch& patch) {
  const Primitive& primitive = gltf.primitives[use.primitive];
  const auto faces = face_vertices(gltf, unwrapped, primitive);
  TangentMesh soup = soup_of(gltf, primitive, faces);
  const auto own = attribute(gltf, primitive, "TANGENT", 4);
  const auto renewed = written.find(primitive.piece);
  const CornerTangents before =
      own ? stored(gltf, *own, faces) : computed(gltf, soup, patch, &texture::PlacedTriangle::from);
  const CornerTangents after = own && renewed != written.end() ? renewed->second
                               : own                           ? before
                                     : computed(gltf, soup, patch, &texture::PlacedTriangle::to);
  patch.frames.resize(faces.size());
  for (std::size_t t = 0; t < faces.size(); ++t) {
    texture::TurnedFrames& frames = patch.frames[t];
    frames.from_sign = before[t][0][3];
    frames.to_sign = after[t][0][3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& normal = soup.normals[3 * t + k];
      frames.corner[k] = {normal.cast<float>(), axis_of(before[t][k], normal, use.mapping.turn),
                          axis_of(after[t][k], normal, use.mapping.turn)};
    }
  }
}

}  // namespace unwrapd::asset::writer
