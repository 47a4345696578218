#include "tests/pipeline/textured_scene.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>

#include "core/asset/writer/tangent_space.hpp"
#include "core/texture/codec.hpp"

namespace unwrapd::test {
namespace {

using asset::test::Json;
using texture::Image;

double from_srgb(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }

std::string bin_of(const std::string& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  return glb.substr(20 + length + 8);
}

Vec2 vec2(const std::vector<double>& v) { return {v.at(0), v.at(1)}; }
Vec3 vec3(const std::vector<double>& v) { return {v.at(0), v.at(1), v.at(2)}; }

SceneFace face_of(const asset::test::Face& read, int material) {
  SceneFace face;
  face.material = material;
  const auto points = asset::test::points_of(read);
  const Vec3 flat = (points[1] - points[0]).cross(points[2] - points[0]).normalized();
  for (std::size_t k = 0; k < 3; ++k) {
    SceneCorner& corner = face.corner[k];
    corner.position = points[k];
    corner.normal = read.contains("NORMAL") ? vec3(read.at("NORMAL")[k]) : flat;
    corner.uv = read.contains("TEXCOORD_0") ? vec2(read.at("TEXCOORD_0")[k]) : Vec2(0, 0);
    if (read.contains("TANGENT")) {
      const std::vector<double>& t = read.at("TANGENT")[k];
      corner.tangent = {t[0], t[1], t[2], t[3]};
    }
  }
  return face;
}

/// What readers do without tangents.
void compute_tangents(std::vector<SceneFace>& faces) {
  asset::writer::TangentMesh mesh;
  for (const SceneFace& face : faces) {
    const auto first = static_cast<Index>(mesh.positions.size());
    mesh.faces.push_back({first, first + 1, first + 2});
    for (const SceneCorner& corner : face.corner) {
      mesh.positions.push_back(corner.position);
      mesh.normals.push_back(corner.normal);
      mesh.uv.emplace_back(corner.uv.x(), 1 - corner.uv.y());
    }
  }
  const auto tangents = asset::writer::corner_tangents(mesh, {});
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      faces[f].corner[k].tangent = {tangents[f][k][0], tangents[f][k][1], tangents[f][k][2],
                                    tangents[f][k][3]};
}

int wrapped(int i, int n, int mode) {
  if (mode == 33071) return std::clamp(i, 0, n - 1);
  const int k = ((i % (2 * n)) + 2 * n) % (2 * n);
  if (mode == 33648) return k < n ? k : 2 * n - 1 - k;
  return k % n;
}

using Key = std::array<double, 5>;

Key key_of(const SceneCorner& corner) {
  return {corner.position.x(), corner.position.y(), corner.position.z(), corner.uv.x(),
          corner.uv.y()};
}

}  // namespace

TexturedScene::TexturedScene(const std::string& glb) : json_(asset::test::json_of(glb)) {
  const std::string bin = bin_of(glb);
  for (const auto& primitive : asset::test::read_naively(glb)) {
    std::vector<SceneFace> faces;
    for (const auto& face : primitive.faces)
      faces.push_back(face_of(face, primitive.json.value("material", -1)));
    if (!faces.empty() && faces[0].corner[0].tangent.isZero()) compute_tangents(faces);
    faces_.insert(faces_.end(), faces.begin(), faces.end());
  }
  for (const Json& image : json_.value("images", Json::array())) {
    const Json& view = json_["bufferViews"][image["bufferView"].get<std::size_t>()];
    const std::string bytes =
        bin.substr(view.value("byteOffset", std::size_t{0}), view["byteLength"].get<std::size_t>());
    const texture::ImageFile file{bytes, ""};
    images_.push_back(texture::decode(file, texture::head_of(file), {}));
  }
  for (const Json& material : json_.value("materials", Json::array())) {
    Material made;
    const Json pbr = material.value("pbrMetallicRoughness", Json::object());
    if (pbr.contains("baseColorTexture")) made.base = slot_of(pbr["baseColorTexture"]);
    if (material.contains("normalTexture")) made.normal = slot_of(material["normalTexture"]);
    materials_.push_back(made);
  }
}

TexturedScene::Slot TexturedScene::slot_of(const Json& info) const {
  Slot slot;
  const Json& texture = json_["textures"][info["index"].get<std::size_t>()];
  const bool is_webp = texture.contains("extensions");
  slot.image = (is_webp ? texture["extensions"]["EXT_texture_webp"] : texture)["source"];
  if (texture.contains("sampler")) {
    const Json& sampler = json_["samplers"][texture["sampler"].get<std::size_t>()];
    slot.wrap = {sampler.value("wrapS", 10497), sampler.value("wrapT", 10497)};
  }
  if (!info.contains("extensions")) return slot;
  const Json& transform = info["extensions"]["KHR_texture_transform"];
  if (transform.contains("offset")) slot.offset = vec2(transform["offset"]);
  if (transform.contains("scale")) slot.scale = vec2(transform["scale"]);
  slot.rotation = transform.value("rotation", 0.0);
  return slot;
}

Vec3 TexturedScene::sample(const Slot& slot, const Vec2& at, bool is_srgb) const {
  const Image& image = images_[static_cast<std::size_t>(slot.image)];
  const double c = std::cos(slot.rotation), s = std::sin(slot.rotation);
  const Vec2 scaled = at.cwiseProduct(slot.scale);
  const Vec2 uv =
      Vec2(c * scaled.x() + s * scaled.y(), -s * scaled.x() + c * scaled.y()) + slot.offset;
  const double x = uv.x() * image.width - 0.5, y = uv.y() * image.height - 0.5;
  const double fx = x - std::floor(x), fy = y - std::floor(y);
  static const std::array<double, 256> light = [] {
    std::array<double, 256> made{};
    for (int i = 0; i < 256; ++i) made[static_cast<std::size_t>(i)] = from_srgb(i / 255.0);
    return made;
  }();
  const auto texel = [&](int dx, int dy) {
    const std::uint8_t* rgba =
        image.at(wrapped(static_cast<int>(std::floor(x)) + dx, image.width, slot.wrap[0]),
                 wrapped(static_cast<int>(std::floor(y)) + dy, image.height, slot.wrap[1]));
    Vec3 colour;
    for (int k = 0; k < 3; ++k) colour[k] = is_srgb ? light[rgba[k]] : rgba[k] / 255.0;
    return colour;
  };
  return (1 - fy) * ((1 - fx) * texel(0, 0) + fx * texel(1, 0)) +
         fy * ((1 - fx) * texel(0, 1) + fx * texel(1, 1));
}

Vec3 TexturedScene::look(std::size_t number, const Vec3& weights, Look look) const {
  const SceneFace& face = faces_[number];
  Vec2 uv = Vec2::Zero();
  Vec3 normal = Vec3::Zero(), tangent = normal;
  for (std::size_t k = 0; k < 3; ++k) {
    const double w = weights[static_cast<int>(k)];
    uv += w * face.corner[k].uv;
    normal += w * face.corner[k].normal;
    tangent += w * face.corner[k].tangent.head<3>();
  }
  const Material material =
      face.material < 0 ? Material{} : materials_[static_cast<std::size_t>(face.material)];
  if (look == Look::base_colour)
    return material.base.image < 0 ? Vec3(0.5, 0.5, 0.5) : sample(material.base, uv, true);
  if (material.normal.image < 0) return normal.normalized();
  const Vec3 bent = 2 * sample(material.normal, uv, false) - Vec3(1, 1, 1);
  const Vec3 bitangent = face.corner[0].tangent.w() * normal.cross(tangent);
  return (bent.x() * tangent + bent.y() * bitangent + bent.z() * normal).normalized();
}

std::vector<int> TexturedScene::charts() const {
  std::vector<int> chart(faces_.size());
  std::iota(chart.begin(), chart.end(), 0);
  const auto root = [&](int f) {
    while (chart[static_cast<std::size_t>(f)] != f) f = chart[static_cast<std::size_t>(f)];
    return f;
  };
  std::map<std::pair<Key, Key>, int> open;
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const Key a = key_of(faces_[f].corner[k]), b = key_of(faces_[f].corner[(k + 1) % 3]);
      if (const auto found = open.find({b, a}); found != open.end())
        chart[static_cast<std::size_t>(root(static_cast<int>(f)))] = root(found->second);
      open.insert_or_assign({a, b}, static_cast<int>(f));
    }
  for (std::size_t f = 0; f < faces_.size(); ++f) chart[f] = root(static_cast<int>(f));
  return chart;
}

}  // namespace unwrapd::test
