#pragma once
// Wavefront OBJ: the author's text is kept, except for texture coordinates and faces.

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/asset/base/colour.hpp"
#include "core/asset/base/input.hpp"
#include "core/asset/base/pace.hpp"
#include "core/asset/obj/mtl.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/file_repair.hpp"

namespace unwrapd::asset::obj {

/// A statement whose corners are rewritten: a face (keyword 'f') or a polyline ('l').
struct Element {
  char keyword = 'f';
  std::size_t begin = 0;  ///< bytes of the statement in the text, without comment and line end
  std::size_t end = 0;
  std::size_t first_corner = 0;  ///< in Obj::corners
  std::size_t corner_count = 0;
  std::size_t first_face = 0;  ///< of the surface's faces; there are face_count()

  [[nodiscard]] std::size_t face_count() const {
    return keyword == 'f' && corner_count > 2 ? corner_count - 2 : 0;
  }
};

inline constexpr Index kNoNormal = -1, kNoTexcoord = -1;

struct Corner {
  Index vertex = 0;
  Index normal = kNoNormal;
  Index texcoord = kNoTexcoord;  ///< as in the file; may name a vt that does not exist
};

struct Obj {
  std::string text;
  std::vector<Element> elements;  ///< in the order of the text
  std::vector<Corner> corners;
  std::vector<std::array<Index, 3>>
      face_corners;  ///< [face]: the corners of its element that it uses
  std::vector<std::pair<std::size_t, std::size_t>> texcoord_lines;  ///< their bytes, in order
  std::vector<Vec3> normals;
  std::vector<std::string> materials;  ///< [part]: the name after usemtl, empty before the first
  std::vector<std::string> libraries;  ///< after mtllib, as written
  MtlLibrary looks;                    ///< materials of those that were sent
  std::map<std::string, std::string> images;  ///< sent ones that these use, by their paths
  std::vector<FileRepair> repairs;
  std::vector<Colour> colours;  ///< one a vertex, NaN where it has none; empty if none has
  bool has_names = false;       ///< of objects or groups
  bool has_points = false;
  std::stop_token stop;  ///< of the job, for reading and writing

  /// Whether usemtl names one. Part 0 has none.
  [[nodiscard]] bool has_materials() const { return materials.size() > 1; }
};

/// Throws Error{malformed_obj, non_finite_position, too_many_*, no_triangles} with the line, and
/// Error{cancelled}.
Obj read_obj(const Input& input, const ReadLimits& limits, Surface& surface);

/// The text with new vt statements, and faces as v/vt[/vn]. A polygon stays one if polygon_fate()
/// allows it.
std::string write_obj(const Obj& obj, const UnwrappedSurface& unwrapped);

/// The texture coordinates of an OBJ, V pointing up; NaN where they cannot be read.
std::vector<Vec2> texcoords_of(const Obj& obj);

/// Cuts a polygon of at least 3 corners into corner_count - 2 triangles, by ears if it is not
/// convex. Appends corner numbers. Throws Error{cancelled}.
void triangulate(std::span<const Vec3> polygon, std::vector<std::array<Index, 3>>& triangles,
                 Pace& pace);

}  // namespace unwrapd::asset::obj
