// Values of vertices: colours, as the file was read, and other properties of a PLY. These are read
// in a pass of their own, which jobs without painted preferences do not make.
#include <algorithm>
#include <array>

#include "core/asset/mesh_files/ply.hpp"
#include "core/asset/painted.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::array<std::string_view, 4> kPlyColours = {"red", "green", "blue", "alpha"};

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

std::vector<double> colour_values(std::span<const Colour> colours, const AttributeName& name,
                                  const std::string& what) {
  const auto has = [&](std::size_t channel) {
    return std::ranges::any_of(colours, [&](const Colour& own) { return own[channel] >= 0; });
  };
  const bool has_colours = has(0);
  if (name.base != kColourAttribute || !has(name.channel.value_or(0)))
    refuse_missing(name, what,
                   has_colours ? std::vector<std::string>{std::string(kColourAttribute)}
                               : std::vector<std::string>());
  std::vector<double> values;
  values.reserve(colours.size());
  for (const Colour& colour : colours) values.push_back(value_of(colour, name.channel));
  return values;
}

std::vector<double> ply_values(const Input& input, const AttributeName& name) {
  return PlyValueReader(input, name).read();
}

}  // namespace unwrapd::asset
