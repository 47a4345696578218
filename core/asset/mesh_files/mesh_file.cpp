#include "core/asset/mesh_files/mesh_file.hpp"

#include <algorithm>
#include <limits>

#include "core/asset/base/as_size.hpp"
#include "core/asset/obj/obj.hpp"
#include "core/base/error.hpp"

namespace unwrapd::asset::mesh_files {
namespace {

constexpr double kMostFloat = std::numeric_limits<float>::max();
constexpr std::size_t kMaxNamed = 8;  // names that a note repeats

std::string upper(std::string_view name) {
  std::string text(name);
  for (char& c : text) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return text;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxNamed); ++i)
    text += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kMaxNamed)
    text += " and " + std::to_string(names.size() - kMaxNamed) + " more";
  return text;
}

/// Appends one polygon's triangles to the surface.
class FaceCutter {
 public:
  FaceCutter(Surface& surface, Pace& pace) : mesh_(surface.mesh), pace_(pace) {}

  void cut(std::span<const Index> corners) {
    if (corners.size() == 3) {
      mesh_.faces.push_back({corners[0], corners[1], corners[2]});
      return;
    }
    points_.clear();
    triangles_.clear();
    for (const Index corner : corners) points_.push_back(mesh_.positions[as_size(corner)]);
    obj::triangulate(points_, triangles_, pace_);
    for (const auto& [a, b, c] : triangles_)
      mesh_.faces.push_back({corners[as_size(a)], corners[as_size(b)], corners[as_size(c)]});
  }

 private:
  TriMesh& mesh_;
  Pace& pace_;
  std::vector<Vec3> points_;
  std::vector<std::array<Index, 3>> triangles_;
};

}  // namespace

void refuse_mesh(const std::string& message, const std::string& where) {
  throw Error(ErrorCode::malformed_mesh, message + "; export the mesh again", where);
}

void check_vertex_count(std::int64_t count, const ReadLimits& limits) {
  if (count > std::min<std::int64_t>(limits.max_vertices, std::numeric_limits<Index>::max()))
    throw Error(ErrorCode::too_many_vertices, "the mesh has more than " +
                                                  std::to_string(limits.max_vertices) +
                                                  " vertices; simplify it or split it");
}

void check_face_count(std::int64_t count, const ReadLimits& limits) {
  if (count > std::min<std::int64_t>(limits.max_faces, std::numeric_limits<Index>::max() / 3))
    throw Error(ErrorCode::too_many_faces, "the mesh has more than " +
                                               std::to_string(limits.max_faces) +
                                               " triangles; simplify it or split it");
}

bool is_position(const Vec3& position) {
  return position.allFinite() && position.cwiseAbs().maxCoeff() <= kMostFloat;
}

void refuse_position(const std::string& where) {
  throw Error(ErrorCode::non_finite_position,
              "a coordinate is infinite, undefined or beyond what a float holds; repair the mesh",
              where);
}

void add_faces(const PolygonList& polygons, const ReadLimits& limits, Surface& surface,
               MeshFile& file) {
  Pace pace(file.stop);
  FaceCutter cutter(surface, pace);
  std::size_t begin = 0, total = 0;
  for (const std::size_t end : polygons.ends) {
    total += end - begin > 2 ? end - begin - 2 : 0;
    file.polygon_count += end - begin > 3 ? 1 : 0;
    begin = end;
  }
  if (total == 0)
    throw Error(ErrorCode::no_triangles, "the mesh has no faces; send one with at least one");
  check_face_count(static_cast<std::int64_t>(total), limits);
  surface.mesh.faces.reserve(total);
  begin = 0;
  for (const std::size_t end : polygons.ends) {
    pace.add(1);
    if (end - begin > 2) cutter.cut(std::span(polygons.corners).subspan(begin, end - begin));
    begin = end;
  }
  surface.part.assign(total, 0);
}

std::vector<Note> note_on_mesh_file(const MeshFile& file, Format input, Format output) {
  const std::string name = upper(format_name(input));
  std::vector<Note> notes = {
      {NoteCode::format_changed,
       "The input is " + name +
           ", which has no place for texture coordinates with seams; the result is in another "
           "format."}};
  if (file.polygon_count > 0)
    notes.push_back({NoteCode::polygons_split,
                     std::to_string(file.polygon_count) +
                         " faces have more than three corners; they are written as triangles."});
  std::vector<std::string> dropped = file.dropped;
  const auto is_transparent = [](const Colour& colour) { return colour[3] < 1; };
  if (output == Format::obj && std::ranges::any_of(file.colours, is_transparent))
    dropped.emplace_back("vertex alpha");
  if (!dropped.empty())
    notes.push_back({NoteCode::data_dropped, "The result lacks these properties of the " + name +
                                                 ": " + listed(dropped) + "."});
  return notes;
}

}  // namespace unwrapd::asset::mesh_files
