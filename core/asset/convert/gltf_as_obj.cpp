// Writes geometry, UVs, normals and colours of a glTF; OBJ has no more. Normals are written corner
// by corner, since the pieces of a surface may have different ones at the same vertex.
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/pace.hpp"
#include "core/asset/convert/convert.hpp"
#include "core/asset/gltf/elements.hpp"
#include "core/asset/gltf/scene.hpp"
#include "core/asset/obj/text.hpp"
#include "core/base/cancel.hpp"
#include "core/base/srgb.hpp"

namespace unwrapd::asset::convert {
namespace {

/// The accessor of a triangle primitive's attribute; none if it has fewer components or a type that
/// glTF does not allow.
std::optional<std::size_t> accessor_of(const Gltf& gltf, const Primitive& primitive,
                                       std::string_view semantic, std::size_t components) {
  const auto found = std::ranges::find(primitive.attributes, semantic,
                                       &std::pair<std::string, std::size_t>::first);
  if (found == primitive.attributes.end() || !primitive.has_triangles) return std::nullopt;
  const Accessor& accessor = gltf.accessors[found->second];
  if (accessor.components < components || accessor.type == ComponentType::u32) return std::nullopt;
  return found->second;
}

/// One for each piece: that of the first primitive that uses the piece.
std::vector<std::optional<std::size_t>> accessors_of(const Gltf& gltf, std::string_view semantic,
                                                     std::size_t components) {
  std::vector<std::optional<std::size_t>> accessors(gltf.pieces.size());
  for (const Primitive& primitive : gltf.primitives)
    if (const auto own = accessor_of(gltf, primitive, semantic, components);
        own && !accessors[primitive.piece])
      accessors[primitive.piece] = own;
  return accessors;
}

/// Of length 1 if the placement is more than a move.
Vec3 placed_normal(const Vec3& normal, const Placement& placement) {
  if (placement.linear.isIdentity(0)) return normal;
  return (placement.mirrors() ? -1 : 1) * (placement.cofactors() * normal).normalized();
}

bool has_alpha(const Gltf& gltf, std::size_t accessor) {
  if (gltf.accessors[accessor].components < 4) return false;
  const Elements colours(gltf, accessor);
  for (std::size_t i = 0; i < gltf.accessors[accessor].count; ++i) {
    check_cancelled_every(i, gltf.stop);
    if (colours.component_of(i, 3) != 1) return true;
  }
  return false;
}

/// What the OBJ lacks of the glTF's colours.
struct LackingColours {
  /// Sets but the first, or colours of vertices that another primitive colours otherwise.
  bool others = false;
  bool alpha = false;
};

LackingColours lacking_colours(const Gltf& gltf) {
  LackingColours lacking;
  std::map<std::pair<std::size_t, std::size_t>, std::optional<std::size_t>> of_vertices;
  std::set<std::size_t> seen;
  for (const Primitive& primitive : gltf.primitives) {
    const auto count = std::ranges::count_if(primitive.attributes, [](const auto& attribute) {
      return attribute.first.starts_with("COLOR_");
    });
    const auto own = accessor_of(gltf, primitive, "COLOR_0", 3);
    lacking.others |= count > (own ? 1 : 0);
    if (!primitive.has_triangles) continue;
    const std::pair vertices(gltf.pieces[primitive.piece].surface, primitive.position);
    lacking.others |= of_vertices.try_emplace(vertices, own).first->second != own;
    lacking.alpha = lacking.alpha || (own && seen.insert(*own).second && has_alpha(gltf, *own));
  }
  return lacking;
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
  const LackingColours colours = lacking_colours(gltf);
  add(colours.others, "other colours of vertices");
  add(colours.alpha, "the alpha of colours");
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
        normal_accessors_(accessors_of(gltf, "NORMAL", 3)),
        colour_accessors_(accessors_of(gltf, "COLOR_0", 3)),
        placements_(first_placements(gltf, surfaces)) {}

  std::string write() {
    std::size_t piece = 0;
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      throw_if_cancelled(gltf_.stop);
      out_ += "o " + object_name(s) + '\n';
      append_vertices(s, colours_of(s, piece));
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

  /// Of the surface's vertices, white where they have none; empty if none has.
  [[nodiscard]] std::vector<Colour> colours_of(std::size_t surface, std::size_t piece) const {
    std::vector<Colour> colours;
    for (; piece < gltf_.pieces.size() && belongs(gltf_.pieces[piece], surface); ++piece) {
      if (!colour_accessors_[piece] || gltf_.pieces[piece].face_count == 0) continue;
      colours.resize(surfaces_[surface].mesh.positions.size(), Colour{1, 1, 1, 1});
      read_colours(gltf_.pieces[piece], *colour_accessors_[piece], colours);
    }
    return colours;
  }

  void read_colours(const Piece& piece, std::size_t accessor, std::vector<Colour>& colours) const {
    const Elements linear(gltf_, accessor);
    std::vector<char> is_read(colours.size(), 0);
    for (std::size_t t = piece.first_face; t < piece.first_face + piece.face_count; ++t) {
      check_cancelled_every(t, gltf_.stop);
      for (const Index v : surfaces_[piece.surface].mesh.faces[t]) {
        if (std::exchange(is_read[as_size(v)], 1) != 0) continue;
        const Index vertex = gltf_.vertices[piece.surface][as_size(v)];
        for (std::size_t k = 0; k < 3; ++k) {
          const double light = linear.component_of(as_size(vertex), k);
          colours[as_size(v)][k] =
              static_cast<float>(to_srgb(light > 0 ? std::min(light, 1.0) : 0));
        }
      }
    }
  }

  void append_vertices(std::size_t surface, const std::vector<Colour>& colours) {
    Pace pace(gltf_.stop);
    const std::vector<Vec3>& positions = surfaces_[surface].mesh.positions;
    for (std::size_t v = 0; v < positions.size(); ++v) {
      pace.add(8);
      const Colour* const colour = colours.empty() ? nullptr : &colours[v];
      obj::append_v(out_, placements_[surface](positions[v]), colour);
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
        obj::append_vn(out_, normal.allFinite() ? normal : Vec3(0, 0, 0));
      }
    }
  }

  const Gltf& gltf_;
  std::span<const Surface> surfaces_;
  std::span<const UnwrappedSurface> unwrapped_;
  std::vector<std::optional<std::size_t>> normal_accessors_;  ///< one a piece
  std::vector<std::optional<std::size_t>> colour_accessors_;
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
