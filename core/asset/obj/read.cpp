// One pass over the text reads vertices, normals and faces; all else is only kept. Indices are
// checked at the end, since a face may precede its vertices.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/words.hpp"
#include "core/asset/obj/materials.hpp"
#include "core/asset/obj/obj.hpp"
#include "core/base/cancel.hpp"
#include "core/base/error.hpp"

namespace unwrapd::asset::obj {
namespace {

constexpr double kLargest = std::numeric_limits<float>::max();
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

std::string line_of(std::string_view text, std::size_t byte) {
  const auto lines = std::count(text.begin(), text.begin() + std::ptrdiff_t(byte), '\n');
  return "line " + std::to_string(lines + 1);
}

class ObjReader {
 public:
  ObjReader(const Input& input, const ReadLimits& limits, Surface& surface)
      : limits_(limits), surface_(surface), pace_(input.stop) {
    obj_.text = input.document;
    obj_.stop = input.stop;
    line_ends_ = replace_lone_returns(obj_.text);
  }

  Obj read() {
    at_.next = obj_.text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    while (at_.next < obj_.text.size()) {
      at_ = statement_at(obj_.text, at_.next);
      pace_.add(1 + (at_.next - at_.begin) / 16);
      read_statement(Words(std::string_view(obj_.text).substr(at_.begin, at_.end - at_.begin)));
    }
    obj_.materials.resize(part_of_.size());
    for (const auto& [name, part] : part_of_) obj_.materials[as_size(part)] = name;
    normalize_colours(obj_.colours);
    check_indices();
    triangulate_faces();
    note(FileRepairKind::line_ends_replaced, line_ends_);
    note(FileRepairKind::empty_indices_ignored, empty_indices_);
    note(FileRepairKind::normals_replaced, bad_normals_);
    return std::move(obj_);
  }

 private:
  void note(FileRepairKind kind, std::int64_t count) {
    if (count > 0) obj_.repairs.push_back({kind, count});
  }

  [[noreturn]] void refuse(ErrorCode code, const std::string& message) const {
    throw Error(code, message, line_of(obj_.text, at_.begin));
  }

  [[noreturn]] void refuse(const std::string& message) const {
    refuse(ErrorCode::malformed_obj, message + "; correct the line or export the mesh again");
  }

  void read_statement(Words words) {
    const std::string_view keyword = words.next();
    if (keyword == "v") {
      read_vertex(words);
    } else if (keyword == "f" || keyword == "l") {
      read_element(keyword.front(), words);
    } else if (keyword == "vn") {
      obj_.normals.push_back(read_normal(words));
    } else if (keyword == "vt") {
      ++texcoord_count_;
      obj_.texcoord_lines.emplace_back(at_.begin, at_.next);
    } else if (keyword == "o" || keyword == "g") {
      obj_.has_names = true;
    } else if (keyword == "p") {
      obj_.has_points = true;
    } else if (keyword == "mtllib") {
      obj_.libraries.emplace_back(words.rest());
    } else if (keyword == "usemtl") {
      part_ = part_of_.try_emplace(std::string(words.rest()), Index(part_of_.size())).first->second;
    }
  }

  void read_vertex(Words& words) {
    if (static_cast<std::int64_t>(surface_.mesh.positions.size()) >= limits_.max_vertices)
      refuse(ErrorCode::too_many_vertices, "the mesh has more than " +
                                               std::to_string(limits_.max_vertices) +
                                               " vertices; simplify it or split it");
    surface_.mesh.positions.push_back(read_vec3(words));
    std::optional<Colour> colour = colour_in(words);  // a single number is a weight
    add_colour(colour, surface_.mesh.positions.size(), obj_.colours);
  }

  Vec3 read_vec3(Words& words) const {
    const double x = read_number(words.next());
    const double y = read_number(words.next());
    return {x, y, read_number(words.next())};
  }

  /// No UV depends on a normal, so all are accepted: exporters write nan for faces without area.
  Vec3 read_normal(Words& words) {
    Vec3 normal;
    for (double& x : normal) {
      const std::optional<double> value = number_in(words.next());
      x = value.value_or(std::numeric_limits<double>::quiet_NaN());
    }
    if (normal.allFinite() && normal.cwiseAbs().maxCoeff() <= kLargest) return normal;
    ++bad_normals_;
    return Vec3::Zero();
  }

  [[nodiscard]] double read_number(std::string_view word) const {
    const std::optional<double> value = number_in(word);
    if (!value)
      refuse("a number is expected where \"" + std::string(word.substr(0, 40)) + "\" stands");
    if (!(std::abs(*value) <= kLargest))
      refuse(ErrorCode::non_finite_position,
             "a coordinate is infinite, undefined or beyond what a float holds; repair the mesh");
    return *value;
  }

  void read_element(char keyword, Words& words) {
    Element element{keyword, at_.begin, at_.end, obj_.corners.size(), 0, 0};
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      pace_.add(1);
      obj_.corners.push_back(read_corner(word));
    }
    element.corner_count = obj_.corners.size() - element.first_corner;
    element.first_face = face_total_;
    face_total_ += element.face_count();
    if (face_total_ > static_cast<std::size_t>(limits_.max_faces))
      refuse(ErrorCode::too_many_faces, "the mesh has more than " +
                                            std::to_string(limits_.max_faces) +
                                            " triangles; simplify it or split it");
    surface_.part.resize(face_total_, part_);
    obj_.elements.push_back(element);
  }

  /// v, v/vt, v//vn or v/vt/vn; an index may be missing after its slash.
  [[nodiscard]] Corner read_corner(std::string_view word) {
    Corner corner;
    std::string_view rest = word;
    corner.vertex = read_index(rest, surface_.mesh.positions.size());
    const auto take_slash = [&] {
      if (!rest.starts_with('/')) return false;
      rest.remove_prefix(1);
      return true;
    };
    bool is_open = take_slash();
    if (is_open && !rest.empty() && rest.front() != '/') {
      corner.texcoord = read_index(rest, texcoord_count_);
      is_open = false;
    }
    if (take_slash()) {
      is_open = rest.empty();
      if (!rest.empty()) corner.normal = read_index(rest, obj_.normals.size());
    }
    if (!rest.empty()) refuse("\"" + std::string(word.substr(0, 40)) + "\" is no corner of a face");
    empty_indices_ += is_open ? 1 : 0;
    return corner;
  }

  /// An index from 1 upwards, or a negative one that counts backwards from the latest.
  Index read_index(std::string_view& rest, std::size_t count) const {
    Index number = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    const auto latest = static_cast<std::int64_t>(count);
    if (error != std::errc() || number == 0 || number + latest < 0)
      refuse("\"" + std::string(rest.substr(0, 40)) + "\" is no index of a corner");
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return number > 0 ? number - 1 : static_cast<Index>(number + latest);
  }

  void check_indices() {
    const auto vertex_count = surface_.mesh.vertex_count();
    const auto normal_count = static_cast<Index>(obj_.normals.size());
    for (const Element& element : obj_.elements) {
      pace_.add(1 + element.corner_count);
      at_.begin = element.begin;
      for (std::size_t i = 0; i < element.corner_count; ++i) {
        const Corner& corner = obj_.corners[element.first_corner + i];
        if (corner.vertex >= vertex_count)
          refuse("vertex " + std::to_string(corner.vertex + 1) + " does not exist: there are " +
                 std::to_string(vertex_count));
        if (corner.normal >= normal_count)
          refuse("normal " + std::to_string(corner.normal + 1) + " does not exist: there are " +
                 std::to_string(normal_count));
      }
    }
  }

  void triangulate_faces() {
    if (face_total_ == 0)
      throw Error(ErrorCode::no_triangles, "the mesh has no faces; send one with at least one");
    obj_.face_corners.reserve(face_total_);
    surface_.mesh.faces.reserve(face_total_);
    std::vector<Vec3> polygon;
    for (const Element& element : obj_.elements) {
      if (element.face_count() == 0) continue;
      const Corner* corners = &obj_.corners[element.first_corner];
      polygon.clear();
      for (std::size_t i = 0; i < element.corner_count; ++i)
        polygon.push_back(surface_.mesh.positions[static_cast<std::size_t>(corners[i].vertex)]);
      triangulate(polygon, obj_.face_corners, pace_);
      for (std::size_t t = element.first_face; t < obj_.face_corners.size(); ++t) {
        const std::array<Index, 3>& face = obj_.face_corners[t];
        surface_.mesh.faces.push_back(
            {corners[face[0]].vertex, corners[face[1]].vertex, corners[face[2]].vertex});
      }
    }
  }

  const ReadLimits& limits_;
  Surface& surface_;
  Pace pace_;
  Obj obj_;
  Statement at_;
  std::size_t texcoord_count_ = 0;
  std::size_t face_total_ = 0;
  std::int64_t line_ends_ = 0, empty_indices_ = 0, bad_normals_ = 0;  ///< repaired
  Index part_ = 0;
  std::map<std::string, Index> part_of_ = {{"", 0}};
};

}  // namespace

Obj read_obj(const Input& input, const ReadLimits& limits, Surface& surface) {
  Obj obj = ObjReader(input, limits, surface).read();
  read_materials(input, obj);
  return obj;
}

}  // namespace unwrapd::asset::obj
