// Writes geometry, UVs and normals of a glTF; OBJ has no more. Normals are written corner by
// corner, since the pieces of a surface may have different ones at the same vertex.
#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/pace.hpp"
#include "core/asset/convert/convert.hpp"
#include "core/asset/gltf/elements.hpp"
#include "core/asset/gltf/scene.hpp"
#include "core/asset/obj/text.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::convert {
namespace {

/// The accessor of a piece's normals: that of the first primitive that uses the piece.
std::vector<std::optional<std::size_t>> normals_of_pieces(const Gltf& gltf) {
  std::vector<std::optional<std::size_t>> normals(gltf.pieces.size());
  for (const Primitive& primitive : gltf.primitives)
    for (const auto& [semantic, accessor] : primitive.attributes)
      if (semantic == "NORMAL" && primitive.has_triangles && !normals[primitive.piece] &&
          gltf.accessors[accessor].components == 3 &&
          gltf.accessors[accessor].type != ComponentType::u32)
        normals[primitive.piece] = accessor;
  return normals;
}

/// Of length 1 if the placement is more than a move.
Vec3 placed_normal(const Vec3& normal, const Placement& placement) {
  if (placement.linear.isIdentity(0)) return normal;
  return (placement.mirrors() ? -1 : 1) * (placement.cofactors() * normal).normalized();
}

/// What an OBJ of the glTF does not have, in words.
std::vector<std::string> lacking_parts(const Gltf& gltf) {
  std::vector<std::string> parts;
  const auto add = [&](bool is_there, const char* name) {
    if (is_there) parts.emplace_back(name);
  };
  const auto has_list = [&](const char* name) {
    const auto list = gltf.json.find(name);
    return list != gltf.json.end() && !list->empty();
  };
  const auto has_attribute = [&](std::string_view begin) {
    return std::ranges::any_of(gltf.primitives, [&](const Primitive& primitive) {
      return std::ranges::any_of(primitive.attributes, [&](const auto& attribute) {
        return attribute.first.starts_with(begin) && attribute.first != gltf.texcoord;
      });
    });
  };
  const auto any = [&](auto test) { return std::ranges::any_of(gltf.primitives, test); };
  add(any([](const Primitive& p) { return p.material.has_value(); }), "materials and their images");
  add(has_attribute("COLOR_"), "colours of vertices");
  add(has_attribute("TEXCOORD_"), "other sets of texture coordinates");
  add(has_attribute("_"), "custom attributes");
  add(any([](const Primitive& p) { return !p.targets.empty(); }), "morph targets");
  add(any([](const Primitive& p) { return p.mode < Mode::triangles; }), "points and lines");
  add(has_list("skins"), "skins");
  add(has_list("animations"), "animations");
  return parts;
}

class ObjFromGltf {
 public:
  ObjFromGltf(const Gltf& gltf, std::span<const Surface> surfaces,
              std::span<const UnwrappedSurface> unwrapped)
      : gltf_(gltf),
        surfaces_(surfaces),
        unwrapped_(unwrapped),
        normal_accessors_(normals_of_pieces(gltf)),
        placements_(first_placements(gltf, surfaces)) {}

  std::string write() {
    std::size_t piece = 0;
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      throw_if_cancelled(gltf_.stop);
      out_ += "o " + object_name(s) + '\n';
      append_vertices(s);
      for (; piece < gltf_.pieces.size() && belongs(gltf_.pieces[piece], s); ++piece)
        write_piece(piece);
      vertex_base_ += surfaces_[s].mesh.vertex_count();
      texcoord_base_ += static_cast<Index>(unwrapped_[s].uv.size());
    }
    return std::move(out_);
  }

 private:
  /// Pieces are in the order of their surfaces; those without faces belong to none.
  static bool belongs(const Piece& piece, std::size_t surface) {
    return piece.face_count == 0 || piece.surface == surface;
  }

  void append_vertices(std::size_t surface) {
    Pace pace(gltf_.stop);
    for (const Vec3& position : surfaces_[surface].mesh.positions) {
      pace.add(8);
      obj::append_vec3(out_, "v", placements_[surface](position));
    }
    for (const Vec2& uv : unwrapped_[surface].uv) {
      pace.add(4);
      obj::append_vt(out_, uv);
    }
  }

  /// The mesh's name, on one line, or its number.
  [[nodiscard]] std::string object_name(std::size_t surface) const {
    const Json& mesh = gltf_.json.at(Json::json_pointer(surfaces_[surface].name));
    const auto name = mesh.find("name");
    std::string text = name != mesh.end() && name->is_string() ? name->get<std::string>() : "";
    for (char& c : text)
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    return text.empty() ? "mesh_" + std::to_string(surface) : text;
  }

  void write_piece(std::size_t number) {
    const Piece& piece = gltf_.pieces[number];
    const bool has_normals = normal_accessors_[number].has_value() && piece.face_count > 0;
    if (has_normals) write_normals(piece, *normal_accessors_[number]);
    const UnwrappedSurface& unwrapped = unwrapped_[piece.surface];
    const std::array<std::size_t, 3> order = corner_order(piece.surface);
    for (std::size_t t = piece.first_face; t < piece.first_face + piece.face_count; ++t) {
      check_cancelled_every(t, gltf_.stop);
      out_ += 'f';
      for (const std::size_t k : order)
        append_corner(unwrapped, unwrapped.faces[t][k], has_normals ? normal_base_++ : -1);
      out_ += '\n';
    }
  }

  /// Where the placement mirrors the mesh, its winding is turned with it.
  [[nodiscard]] std::array<std::size_t, 3> corner_order(std::size_t surface) const {
    if (placements_[surface].mirrors()) return {0, 2, 1};
    return {0, 1, 2};
  }

  void append_corner(const UnwrappedSurface& unwrapped, Index corner, Index normal) {
    obj::append_indices(out_, vertex_base_ + unwrapped.source[as_size(corner)],
                        texcoord_base_ + corner, normal);
  }

  void write_normals(const Piece& piece, std::size_t accessor) {
    const Elements normals(gltf_, accessor);
    const Surface& surface = surfaces_[piece.surface];
    const Placement& placement = placements_[piece.surface];
    const std::array<std::size_t, 3> order = corner_order(piece.surface);
    for (std::size_t t = piece.first_face; t < piece.first_face + piece.face_count; ++t) {
      check_cancelled_every(t, gltf_.stop);
      for (const std::size_t k : order) {
        const Index vertex = gltf_.vertices[piece.surface][as_size(surface.mesh.faces[t][k])];
        const Vec3 normal = placed_normal(normals.vec3_at(as_size(vertex)), placement);
        obj::append_vec3(out_, "vn", normal.allFinite() ? normal : Vec3(0, 0, 0));
      }
    }
  }

  const Gltf& gltf_;
  std::span<const Surface> surfaces_;
  std::span<const UnwrappedSurface> unwrapped_;
  std::vector<std::optional<std::size_t>> normal_accessors_;
  std::vector<Placement> placements_;  ///< one a surface
  std::string out_;
  Index vertex_base_ = 0;
  Index texcoord_base_ = 0;
  Index normal_base_ = 0;
};

}  // namespace

std::vector<Note> notes_on_obj_of_gltf(const Gltf& gltf) {
  std::vector<Note> notes;
  if (const std::vector<std::string> lacks = lacking_parts(gltf); !lacks.empty()) {
    std::string text;
    for (const std::string& part : lacks) text += (text.empty() ? "" : ", ") + part;
    notes.push_back({NoteCode::data_dropped, "The OBJ lacks these parts of the glTF: " + text +
                                                 ". Send output=glb to keep them."});
  }
  if (const std::size_t count = repeated_nodes(gltf); count > 0)
    notes.push_back({NoteCode::data_dropped,
                     "The OBJ has each mesh once, where its first node shows it. Further nodes "
                     "that show a mesh again: " +
                         std::to_string(count) + "."});
  return notes;
}

std::string gltf_as_obj(const Gltf& gltf, std::span<const Surface> surfaces,
                        std::span<const UnwrappedSurface> unwrapped) {
  return ObjFromGltf(gltf, surfaces, unwrapped).write();
}

}  // namespace unwrapd::asset::convert
