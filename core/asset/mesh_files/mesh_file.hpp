#pragma once
// STL, PLY and OFF: formats of bare geometry. They are read only: the answer is a glTF or an OBJ,
// since STL and OFF have no place for texture coordinates, and PLY has none for seams.

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/base/colour.hpp"
#include "core/asset/base/input.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/file_repair.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset::mesh_files {

struct MeshFile {
  std::vector<Vec3> normals;         ///< one a vertex, or empty
  UvMap uv;                          ///< one a vertex, V pointing up, or empty
  std::vector<Colour> colours;       ///< one a vertex, or empty
  std::int64_t polygon_count = 0;    ///< of more than 3 corners; the answer has triangles
  std::vector<std::string> dropped;  ///< what the answer leaves out: "vertex red", "face flags"
  std::vector<FileRepair> repairs;   ///< none so far
  std::stop_token stop;              ///< of the job, for reading and writing
};

/// Faces as a file lists them: face i has the corners [ends[i - 1], ends[i]).
struct PolygonList {
  std::vector<Index> corners;
  std::vector<std::size_t> ends;
};

/// Each throws Error{malformed_mesh, non_finite_position, too_many_*, no_triangles} with the byte
/// or the line, and Error{cancelled}. Counts in the file are checked against its length before
/// anything of their size is allocated.
///
/// STL, binary or text. Corners at the same position are one vertex, numbered as they first occur.
MeshFile read_stl(const Input& input, const ReadLimits& limits, Surface& surface);

/// PLY, text or binary of either byte order.
MeshFile read_ply(const Input& input, const ReadLimits& limits, Surface& surface);

/// OFF as text, with or without normals, colours and texture coordinates (NOFF, COFF, STOFF).
MeshFile read_off(const Input& input, const ReadLimits& limits, Surface& surface);

/// Whether the length of the file is the one that binary STL announces.
bool is_binary_stl(std::string_view file);

/// Whether the first word after spaces and comments begins with a keyword of OFF. Throws
/// Error{cancelled}.
bool is_off(std::string_view file, const std::stop_token& stop);

/// Throws Error{malformed_mesh}. where: "byte 84" or "line 3".
[[noreturn]] void refuse_mesh(const std::string& message, const std::string& where);

void check_vertex_count(std::int64_t count, const ReadLimits& limits);
void check_face_count(std::int64_t count, const ReadLimits& limits);

/// Whether floats hold the position.
bool is_position(const Vec3& position);

/// Throws Error{non_finite_position}.
[[noreturn]] void refuse_position(const std::string& where);

/// Cuts the polygons into the surface's triangles; those of less than 3 corners are left out.
void add_faces(const PolygonList& polygons, const ReadLimits& limits, Surface& surface,
               MeshFile& file);

/// Notes on what the answer lacks, and why it is not in the format of the input.
std::vector<Note> note_on_mesh_file(const MeshFile& file, Format input, Format output);

}  // namespace unwrapd::asset::mesh_files
