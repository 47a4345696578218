// Of a PLY, the positions, normals, texture coordinates and colours of the element "vertex" and the
// corners of the elements "face" and "tristrips" are read; all other values are passed over, and
// told.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/asset/mesh_files/mesh_file.hpp"
#include "core/asset/mesh_files/ply.hpp"
#include "core/base/error.hpp"

namespace unwrapd::asset::mesh_files {
namespace {

/// What a value of a vertex means.
enum Role : std::size_t {
  kX,
  kY,
  kZ,
  kNormalX,
  kNormalY,
  kNormalZ,
  kU,
  kV,
  kRed,
  kGreen,
  kBlue,
  kAlpha,
  kRoles
};

struct RoleName {
  std::string_view name;
  Role role;
};

constexpr std::array<RoleName, 21> kRoleNames = {{{"x", kX},
                                                  {"y", kY},
                                                  {"z", kZ},
                                                  {"nx", kNormalX},
                                                  {"ny", kNormalY},
                                                  {"nz", kNormalZ},
                                                  {"s", kU},
                                                  {"t", kV},
                                                  {"u", kU},
                                                  {"v", kV},
                                                  {"texture_u", kU},
                                                  {"texture_v", kV},
                                                  {"texture_s", kU},
                                                  {"texture_t", kV},
                                                  {"red", kRed},
                                                  {"green", kGreen},
                                                  {"blue", kBlue},
                                                  {"alpha", kAlpha},
                                                  {"diffuse_red", kRed},
                                                  {"diffuse_green", kGreen},
                                                  {"diffuse_blue", kBlue}}};

/// Roles from first to needed are used only if all are there; those up to last are optional.
struct RoleGroup {
  Role first, needed, last;
};
constexpr std::array<RoleGroup, 3> kGroups = {
    {{kNormalX, kNormalZ, kNormalZ}, {kU, kV, kV}, {kRed, kBlue, kAlpha}}};

using Values = std::array<double, kRoles>;

bool is_corner_list(const PlyProperty& property) {
  return property.count_type &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

class PlyReader {
 public:
  PlyReader(const Input& input, const ReadLimits& limits, Surface& surface)
      : head_(read_ply_head(input.document, input.stop)),
        values_(input.document, head_, input.stop),
        limits_(limits),
        surface_(surface) {
    file_.stop = input.stop;
  }

  MeshFile read() {
    for (const PlyElement& element : head_.elements) {
      values_.check_fits(element);
      if (element.name == "vertex" && surface_.mesh.positions.empty()) {
        read_vertices(element);
      } else if (element.name == "face") {
        read_lists(element, [&](const PlyProperty& list) { read_corners(list); });
      } else if (element.name == "tristrips") {
        read_lists(element, [&](const PlyProperty& list) { read_strips(list); });
      } else {
        skip(element);
      }
    }
    check_corners();
    add_faces(polygons_, limits_, surface_, file_);
    return std::move(file_);
  }

 private:
  void drop(const PlyElement& element, const PlyProperty& property) {
    file_.dropped.push_back(element.name + " " + property.name);
  }

  /// The role of each property of a vertex; kRoles if it has none. A role is given once, and not
  /// without the others of its group.
  std::vector<Role> roles_of(const PlyElement& element) {
    std::vector<Role> roles;
    for (const PlyProperty& property : element.properties) {
      const auto named = std::ranges::find(kRoleNames, property.name, &RoleName::name);
      const bool is_new = named != kRoleNames.end() && !property.count_type &&
                          std::ranges::find(roles, named->role) == roles.end();
      roles.push_back(is_new ? named->role : kRoles);
    }
    for (const RoleGroup& group : kGroups) {
      const auto count = std::ranges::count_if(
          roles, [&](Role role) { return role >= group.first && role <= group.needed; });
      const std::size_t wanted = group.needed - group.first + 1;
      if (static_cast<std::size_t>(count) < wanted)
        std::ranges::replace_if(
            roles, [&](Role role) { return role >= group.first && role <= group.last; }, kRoles);
    }
    for (std::size_t p = 0; p < roles.size(); ++p)
      if (roles[p] == kRoles) drop(element, element.properties[p]);
    return roles;
  }

  void read_vertices(const PlyElement& element) {
    check_vertex_count(element.count, limits_);
    const std::vector<Role> roles = roles_of(element);
    const auto has = [&](Role role) { return std::ranges::find(roles, role) != roles.end(); };
    if (!has(kX) || !has(kY) || !has(kZ)) values_.refuse("the vertices have no x, y and z");
    const bool has_normals = has(kNormalX), has_uv = has(kU), has_colours = has(kRed);
    surface_.mesh.positions.reserve(static_cast<std::size_t>(element.count));
    for (std::int64_t i = 0; i < element.count; ++i) {
      const Values row = read_vertex(element, roles);
      surface_.mesh.positions.emplace_back(row[kX], row[kY], row[kZ]);
      if (!is_position(surface_.mesh.positions.back())) refuse_position(values_.place());
      if (has_normals) file_.normals.emplace_back(row[kNormalX], row[kNormalY], row[kNormalZ]);
      if (has_uv) file_.uv.emplace_back(row[kU], row[kV]);
      if (has_colours) file_.colours.push_back(colour_of(row, has(kAlpha)));
    }
    normalize_colours(file_.colours, unit_unknown_of(element, roles));
  }

  /// Channels whose type tells no unit.
  static UnitUnknown unit_unknown_of(const PlyElement& element, const std::vector<Role>& roles) {
    UnitUnknown unit_unknown{};
    for (std::size_t p = 0; p < roles.size(); ++p)
      if (roles[p] >= kRed && roles[p] <= kAlpha)
        unit_unknown[roles[p] - kRed] = is_of_floats(element.properties[p].type);
    return unit_unknown;
  }

  static bool is_of_floats(PlyType type) { return type == PlyType::f32 || type == PlyType::f64; }

  static Colour colour_of(const Values& row, bool has_alpha) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {static_cast<float>(row[kRed]), static_cast<float>(row[kGreen]),
            static_cast<float>(row[kBlue]), static_cast<float>(has_alpha ? row[kAlpha] : kNone)};
  }

  /// What is 1 of a colour's channel in the property's type.
  static double unit_of(const PlyProperty& property, Role role) {
    if (role < kRed || is_of_floats(property.type)) return 1;
    return property.type == PlyType::u16 ? 65'535 : 255;
  }

  Values read_vertex(const PlyElement& element, const std::vector<Role>& roles) {
    Values row{};
    for (std::size_t p = 0; p < roles.size(); ++p) {
      if (roles[p] == kRoles) {
        values_.skip(element.properties[p]);
      } else {
        row[roles[p]] =
            values_.next(element.properties[p].type) / unit_of(element.properties[p], roles[p]);
      }
    }
    return row;
  }

  /// take: reads one list of corners.
  template <class Take>
  void read_lists(const PlyElement& element, Take take) {
    const auto found = std::ranges::find_if(element.properties, is_corner_list);
    const PlyProperty* const corners = found == element.properties.end() ? nullptr : &*found;
    for (const PlyProperty& property : element.properties)
      if (&property != corners) drop(element, property);
    for (std::int64_t i = 0; i < element.count && !element.properties.empty(); ++i)
      for (const PlyProperty& property : element.properties)
        &property == corners ? take(property) : values_.skip(property);
  }

  void read_corners(const PlyProperty& list) {
    const std::size_t count = values_.next_count(list);
    for (std::size_t k = 0; k < count; ++k)
      polygons_.corners.push_back(corner_of(values_.next(list.type)));
    polygons_.ends.push_back(polygons_.corners.size());
  }

  Index corner_of(double value) const {
    if (!(value >= 0 && value < std::numeric_limits<Index>::max()) || std::trunc(value) != value)
      values_.refuse("a corner of a face is no number of a vertex");
    return static_cast<Index>(value);
  }

  /// Strips, with -1 between them: each corner makes a triangle with the two before it, every
  /// second one the other way round. A corner that comes twice only leads the strip on.
  void read_strips(const PlyProperty& list) {
    Index first = 0, second = 0;
    std::size_t length = 0;  // corners of the strip so far
    for (std::size_t left = values_.next_count(list); left > 0; --left) {
      const double value = values_.next(list.type);
      if (value == -1) {
        length = 0;
        continue;
      }
      const Index third = corner_of(value);
      if (length >= 2 && first != second && second != third && third != first)
        length % 2 == 0 ? add_triangle(first, second, third) : add_triangle(second, first, third);
      first = std::exchange(second, third);
      ++length;
    }
  }

  void add_triangle(Index a, Index b, Index c) {
    polygons_.corners.insert(polygons_.corners.end(), {a, b, c});
    polygons_.ends.push_back(polygons_.corners.size());
    check_face_count(static_cast<std::int64_t>(polygons_.ends.size()), limits_);
  }

  /// At the end, since the faces may precede the vertices.
  void check_corners() const {
    if (polygons_.corners.empty()) return;
    const Index largest = *std::ranges::max_element(polygons_.corners);
    if (largest >= surface_.mesh.vertex_count())
      values_.refuse("a face names vertex " + std::to_string(largest) +
                     ", counted from 0, which does not exist: there are " +
                     std::to_string(surface_.mesh.vertex_count()));
  }

  void skip(const PlyElement& element) {
    if (element.count > 0) file_.dropped.push_back("element " + element.name);
    for (std::int64_t i = 0; i < element.count && !element.properties.empty(); ++i)
      for (const PlyProperty& property : element.properties) values_.skip(property);
  }

  PlyHead head_;
  PlyValues values_;
  const ReadLimits& limits_;
  Surface& surface_;
  MeshFile file_;
  PolygonList polygons_;
};

}  // namespace

MeshFile read_ply(const Input& input, const ReadLimits& limits, Surface& surface) {
  return PlyReader(input, limits, surface).read();
}

}  // namespace unwrapd::asset::mesh_files
