// Values beyond [0, 1] count as the nearer end, and what is no number as 0: exporters write such
// values where nothing was painted. A colour without a channel counts by the mean of red, green and
// blue: white on black is what people paint.
#include "core/asset/painted.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>
#include <utility>

#include "core/asset/base/as_size.hpp"
#include "core/asset/gltf/elements.hpp"
#include "core/base/cancel.hpp"
#include "core/base/error.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::size_t kShownAttributes = 12, kShownOfAttribute = 60;
constexpr std::string_view kChannels = "rgba";

std::string shortened(std::string_view name) {
  return std::string(name.substr(0, kShownOfAttribute));
}

std::string attributes_in_words(const std::vector<std::string>& names) {
  if (names.empty()) return "they have none";
  std::string text = "they have ";
  for (std::size_t i = 0; i < std::min(names.size(), kShownAttributes); ++i)
    text += (i > 0 ? ", " : "") + shortened(names[i]);
  return names.size() > kShownAttributes ? text + ", ..." : text;
}

[[noreturn]] void refuse_attribute(const AttributeName& name, const std::string& message) {
  throw Error(ErrorCode::invalid_option, message, "/" + std::string(name.option));
}

/// An accessor of a primitive, and the channels of it whose mean counts.
struct Channels {
  std::size_t accessor = 0;
  std::size_t first = 0, count = 1;
};

/// Where a primitive has the values, if it does. An attribute whose name ends in a dot and a letter
/// comes before a channel.
std::optional<Channels> channels_of(const Gltf& gltf, const Primitive& primitive,
                                    const AttributeName& name) {
  const auto accessor_of = [&](const std::string& semantic) -> std::optional<std::size_t> {
    for (const auto& [own, accessor] : primitive.attributes)
      if (own == semantic) return accessor;
    return std::nullopt;
  };
  std::optional<std::size_t> channel;
  std::optional<std::size_t> accessor = accessor_of(name.whole);
  if (!accessor && name.channel) {
    accessor = accessor_of(name.base);
    channel = name.channel;
  }
  if (!accessor) return std::nullopt;
  const std::size_t components = gltf.accessors[*accessor].components;
  if (components != 1 && components != 3 && components != 4)
    refuse_type(name, "has " + std::to_string(components) +
                          " components; name a number (SCALAR) or a colour (VEC3, VEC4)");
  if (!channel) return Channels{*accessor, 0, std::min<std::size_t>(components, 3)};
  if (components == 1 || *channel >= components)
    refuse_type(name, "has no such channel; it has " + std::to_string(components) +
                          (components == 1 ? " component" : " components"));
  return Channels{*accessor, *channel, 1};
}

void list_attributes(const Primitive& primitive, std::vector<std::string>& names) {
  for (const auto& [semantic, accessor] : primitive.attributes)
    if (names.size() <= kShownAttributes && std::ranges::find(names, semantic) == names.end())
      names.push_back(semantic);
}

class GltfValues {
 public:
  GltfValues(const Gltf& gltf, std::span<const Surface> surfaces, const AttributeName& name)
      : gltf_(gltf),
        surfaces_(surfaces),
        name_(name),
        values_(surfaces.size()),
        is_read_(gltf.pieces.size(), 0) {}

  /// One list a surface, empty where it lacks the attribute.
  std::vector<std::vector<double>> read() {
    bool is_any = false;
    std::vector<std::string> names;
    for (const Primitive& primitive : gltf_.primitives) {
      if (!primitive.has_triangles || is_read_[primitive.piece] != 0) continue;
      list_attributes(primitive, names);
      const std::optional<Channels> channels = channels_of(gltf_, primitive, name_);
      if (!channels) continue;
      is_any = true;
      is_read_[primitive.piece] = 1;
      read_piece(gltf_.pieces[primitive.piece], *channels);
    }
    if (!is_any) refuse_missing(name_, "primitive that is unwrapped", names);
    return std::move(values_);
  }

 private:
  /// Primitives that share vertices may have different values there: the greatest counts.
  void read_piece(const Piece& piece, const Channels& channels) {
    const Elements& elements =
        elements_.try_emplace(channels.accessor, gltf_, channels.accessor).first->second;
    const std::vector<Index>& number = gltf_.vertices[piece.surface];
    std::vector<double>& values = values_[piece.surface];
    values.resize(number.size(), 0);
    const std::vector<Triangle>& faces = surfaces_[piece.surface].mesh.faces;
    for (std::size_t t = piece.first_face; t < piece.first_face + piece.face_count; ++t) {
      check_cancelled_every(t, gltf_.stop);
      for (const Index v : faces[t]) {
        double sum = 0;
        for (std::size_t k = 0; k < channels.count; ++k)
          sum += elements.component_of(as_size(number[as_size(v)]), channels.first + k);
        const double own = sum / static_cast<double>(channels.count);
        if (own > values[as_size(v)]) values[as_size(v)] = own;
      }
    }
  }

  const Gltf& gltf_;
  std::span<const Surface> surfaces_;
  const AttributeName& name_;
  std::vector<std::vector<double>> values_;
  std::vector<char> is_read_;
  std::unordered_map<std::size_t, Elements> elements_;
};

std::vector<std::vector<double>> values_of(const Input& input, const Document& document,
                                           const AttributeName& name) {
  if (const Gltf* gltf = std::get_if<Gltf>(&document.source))
    return GltfValues(*gltf, document.surfaces, name).read();
  if (const obj::Obj* obj = std::get_if<obj::Obj>(&document.source))
    return {colour_values(obj->colours, name, "vertex of the OBJ")};
  const auto& colours = std::get<mesh_files::MeshFile>(document.source).colours;
  const bool has_colour = name.base == kColourAttribute && !colours.empty();
  if (document.format == Format::ply && !has_colour) return {ply_values(input, name)};
  if (document.format != Format::stl) return {colour_values(colours, name, "vertex of the file")};
  refuse_attribute(name, "an STL is read without attributes of its vertices; leave out " +
                             std::string(name.option) +
                             ", or send a glTF, an OBJ, a PLY or an OFF");
}

void clamp_values(std::vector<double>& values) {
  for (double& value : values) value = value > 0 ? std::min(value, 1.0) : 0.0;  // NaN: 0
}

}  // namespace

AttributeName attribute_name(std::string_view option, const std::string& given) {
  AttributeName name{option, given, given};
  if (given.size() < 3 || given[given.size() - 2] != '.') return name;
  const std::size_t channel = kChannels.find(given.back());
  if (channel == std::string_view::npos) return name;
  name.base = given.substr(0, given.size() - 2);
  name.channel = channel;
  return name;
}

void refuse_missing(const AttributeName& name, const std::string& what,
                    const std::vector<std::string>& has) {
  refuse_attribute(name, "no " + what + " has the attribute \"" + shortened(name.whole) + "\"; " +
                             attributes_in_words(has));
}

void refuse_type(const AttributeName& name, const std::string& why) {
  refuse_attribute(name, "the attribute \"" + shortened(name.base) + "\" " + why);
}

void read_painted(const Input& input, Document& document) {
  const auto read = [&](std::string_view option, const std::optional<std::string>& given,
                        std::vector<double> Surface::*field) {
    if (!given) return;
    auto values = values_of(input, document, attribute_name(option, *given));
    for (std::size_t s = 0; s < values.size(); ++s) {
      clamp_values(values[s]);
      document.surfaces[s].*field = std::move(values[s]);
    }
  };
  read("seam_avoid", document.options.seam_avoid, &Surface::seam_avoid);
  read("texel_density", document.options.texel_density, &Surface::texel_density);
}

}  // namespace unwrapd::asset
