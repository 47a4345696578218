// Values of vertices of an OBJ, whose colours follow the coordinates (v x y z r g b), and of a PLY,
// whose vertices have any properties. Both are read in a pass of their own, which jobs without
// painted preferences do not make.
#include <algorithm>
#include <array>

#include "core/asset/base/words.hpp"
#include "core/asset/mesh_files/ply.hpp"
#include "core/asset/painted.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::string_view kColourAttribute = "COLOR_0", kStartMark = "\xef\xbb\xbf";
constexpr std::array<std::string_view, 4> kPlyColours = {"red", "green", "blue", "alpha"};

/// The colour of a vertex, if the statement has one after the keyword.
std::optional<Colour> colour_of_vertex(Words words) {
  for (int skipped = 0; skipped < 3; ++skipped) words.next();
  return colour_in(words);
}

double value_of(const Colour& colour, const std::optional<std::size_t>& channel) {
  if (channel) return colour[*channel];
  return (double(colour[0]) + double(colour[1]) + double(colour[2])) / 3;
}

/// The properties of a PLY's vertices whose mean counts.
std::vector<std::string> properties_of(const AttributeName& name) {
  if (name.base != kColourAttribute) return {name.whole};
  const std::size_t first = name.channel.value_or(0), count = name.channel ? 1 : 3;
  return {kPlyColours.begin() + first, kPlyColours.begin() + first + count};
}

/// What the largest number of a colour counts as 1 of.
double unit_of(mesh_files::PlyType type) {
  return type == mesh_files::PlyType::u8 ? 255 : type == mesh_files::PlyType::u16 ? 65535 : 1;
}

class PlyValueReader {
 public:
  PlyValueReader(const Input& input, const AttributeName& name)
      : head_(mesh_files::read_ply_head(input.document, input.stop)),
        values_(input.document, head_, input.stop),
        name_(name),
        wanted_(properties_of(name)) {}

  std::vector<double> read() {
    for (const mesh_files::PlyElement& element : head_.elements) {
      if (element.name == "vertex" && element.count > 0) {
        read_vertices(element);
        break;
      }
      for (std::int64_t i = 0; i < element.count && !element.properties.empty(); ++i)
        for (const mesh_files::PlyProperty& property : element.properties) values_.skip(property);
    }
    return std::move(of_vertex_);
  }

 private:
  [[nodiscard]] bool is_wanted(const mesh_files::PlyProperty& property) const {
    return !property.count_type && std::ranges::find(wanted_, property.name) != wanted_.end();
  }

  void read_vertices(const mesh_files::PlyElement& element) {
    std::vector<std::string> names;
    for (const mesh_files::PlyProperty& property : element.properties)
      names.push_back(property.name);
    const auto count = std::ranges::count_if(
        element.properties,
        [&](const mesh_files::PlyProperty& property) { return is_wanted(property); });
    if (count != std::ssize(wanted_)) refuse_missing(name_, "vertex", names);
    for (std::int64_t i = 0; i < element.count; ++i) {
      double sum = 0;
      for (const mesh_files::PlyProperty& property : element.properties)
        if (is_wanted(property))
          sum += values_.next(property.type) / unit_of(property.type);
        else
          values_.skip(property);
      of_vertex_.push_back(sum / static_cast<double>(count));
    }
  }

  mesh_files::PlyHead head_;
  mesh_files::PlyValues values_;
  const AttributeName& name_;
  std::vector<std::string> wanted_;
  std::vector<double> of_vertex_;
};

}  // namespace

std::vector<double> obj_values(const obj::Obj& obj, const AttributeName& name) {
  std::vector<double> values;
  bool has_colours = false;
  Pace pace(obj.stop);
  const bool is_colour = name.base == kColourAttribute && name.channel.value_or(0) < 3;
  Statement at;
  at.next = obj.text.starts_with(kStartMark) ? kStartMark.size() : 0;
  while (at.next < obj.text.size()) {
    at = statement_at(obj.text, at.next);
    pace.add(1 + (at.next - at.begin) / 16);
    Words words(std::string_view(obj.text).substr(at.begin, at.end - at.begin));
    if (words.next() != "v") continue;
    const std::optional<Colour> colour = colour_of_vertex(words);
    has_colours = has_colours || colour;
    values.push_back(colour && is_colour ? value_of(*colour, name.channel) : 0);
  }
  if (!has_colours || !is_colour)
    refuse_missing(name, "vertex of the OBJ",
                   has_colours ? std::vector<std::string>{std::string(kColourAttribute)}
                               : std::vector<std::string>());
  return values;
}

std::vector<double> ply_values(const Input& input, const AttributeName& name) {
  return PlyValueReader(input, name).read();
}

}  // namespace unwrapd::asset
