// Reads the table for others: rows by name or pointer, defaults, and the body of GET /v1/methods.
#include <algorithm>
#include <array>

#include "api/options.hpp"

namespace unwrapd::api {
namespace {

struct MethodRow {
  Method method;
  std::string_view title;
  std::string_view description;
};

constexpr std::array kMethods = {
    MethodRow{Method::asap, "As similar as possible",
              "Keeps angles (the least squares conformal map); one direct solve."},
    MethodRow{Method::arap, "As rigid as possible",
              "Keeps angles and areas together; alternates between local fits and a global solve."},
    MethodRow{Method::hybrid, "Hybrid",
              "A balance between asap and arap: lambda weighs area against angle."},
    MethodRow{Method::abf, "Angle-based flattening",
              "Keeps angles: finds the nearest angles that close up in the plane (ABF++)."},
    MethodRow{Method::linabf, "Linear angle-based flattening",
              "Keeps angles: linearizes the equations of abf; one solve."},
    MethodRow{Method::cp, "Curvature prescription",
              "Keeps angles: scales edges until all curvature lies at the boundary."},
    MethodRow{
        Method::bff, "Boundary first flattening",
        "Keeps angles: computes the boundary of least area distortion first, then the interior."},
    MethodRow{Method::ic, "Inverse curvature",
              "Flattens a circle-packing metric by the inverse curvature map."},
    MethodRow{Method::slim, "Scalable locally injective mapping",
              "Keeps shape and never flips a triangle (symmetric Dirichlet energy)."},
};

struct PresetRow {
  Preset preset;
  std::string_view title;
  std::string_view description;
};

constexpr std::array kPresets = {
    PresetRow{
        Preset::texture, "Texture",
        "For painting and baking: every surface in charts of little distortion, no texel used "
        "twice, and existing textures keep fitting."},
    PresetRow{Preset::lightmap, "Light map",
              "For baked light: as texture, in an unused set of texture coordinates, with more "
              "padding."},
    PresetRow{Preset::chart, "Chart",
              "For geometry processing: a disk stays one chart at any distortion, and no triangle "
              "is flipped."},
    PresetRow{Preset::paper, "Paper",
              "For comparison with the paper: ten plain iterations, one chart for each component, "
              "no guarantee."},
};

std::string_view type_name(OptionType type) {
  switch (type) {
    case OptionType::choice:
    case OptionType::text:
      return "string";
    case OptionType::number:
    case OptionType::numbers:
      return "number";
    case OptionType::integer:
      return "integer";
    case OptionType::flag:
      return "boolean";
    case OptionType::names:
    case OptionType::objects:
      return "array";
  }
  return {};
}

/// A bound in the option's own type: an integer is written without a fraction.
Json bound(const OptionRow& row, double value) {
  if (row.type == OptionType::integer) return static_cast<std::int64_t>(value);
  return value;
}

/// The maximal length of a list, if the option can be a list.
std::optional<std::size_t> most_items(const OptionRow& row, const Limits& limits) {
  if (row.type == OptionType::numbers) return kMaxNumbers;
  if (row.type == OptionType::names) return kMaxNames;
  if (row.type == OptionType::objects) return static_cast<std::size_t>(limits.*row.limit);
  return std::nullopt;
}

bool has_range(const OptionRow& row) {
  return row.type == OptionType::number || row.type == OptionType::integer ||
         row.type == OptionType::numbers;
}

Json option_json(const OptionRow& row, const Limits& limits) {
  Json json = {{"name", row.name}, {"type", type_name(row.type)}};
  if (row.type == OptionType::choice) {
    json["enum"] = row.choices;
  } else if (has_range(row)) {
    json["minimum"] = bound(row, row.minimum);
    if (const auto maximum = option_maximum(row, limits)) json["maximum"] = bound(row, *maximum);
    if (!row.choices.empty()) json["words"] = row.choices;
  }
  if (const auto most = most_items(row, limits)) json["max_items"] = *most;
  json["default"] = option_default(row, limits);
  json["description"] = row.description;
  json["methods"] = Json::array();
  for (const Method method : row.methods) json["methods"].push_back(method_name(method));
  return json;
}

Json method_json(const MethodRow& row) {
  Json json = {{"name", method_name(row.method)},
               {"title", row.title},
               {"description", row.description},
               {"options", Json::array()}};
  for (const OptionRow& option : option_table()) {
    if (has_effect(option, row.method)) json["options"].push_back(option.name);
  }
  return json;
}

/// Whether the presets have different values for this option.
bool is_preset_by(const OptionRow& row, const Limits& limits) {
  const Json first = option_default(row, limits, kPresets.front().preset);
  return std::ranges::any_of(kPresets, [&](const PresetRow& preset) {
    return option_default(row, limits, preset.preset) != first;
  });
}

Json preset_json(const PresetRow& preset, const Limits& limits) {
  Json json = {{"name", preset_name(preset.preset)},
               {"title", preset.title},
               {"description", preset.description},
               {"options", Json::object()}};
  for (const OptionRow& row : option_table())
    if (row.name != "preset" && is_preset_by(row, limits))
      set_member(json["options"], row.name, option_default(row, limits, preset.preset));
  return json;
}

}  // namespace

const OptionRow* find_option(std::string_view name) {
  const auto found = std::ranges::find(option_table(), name, &OptionRow::name);
  return found == option_table().end() ? nullptr : &*found;
}

const OptionRow* option_at(std::string_view pointer) {
  const auto leads_here = [&](const OptionRow& row) {
    const std::string own = option_pointer(row.name);
    return pointer.starts_with(own) && (pointer.size() == own.size() || pointer[own.size()] == '/');
  };
  const auto found = std::ranges::find_if(option_table(), leads_here);
  return found == option_table().end() ? nullptr : &*found;
}

Json option_default(const OptionRow& row, const Limits& limits, Preset preset) {
  return row.get(parse_options({{"preset", preset_name(preset)}}, limits));
}

std::optional<double> option_maximum(const OptionRow& row, const Limits& limits) {
  if (row.type == OptionType::integer && row.limit != nullptr) return limits.*row.limit;
  return row.maximum;
}

bool can_unset(const OptionRow& row) { return row.nullable && row.type != OptionType::numbers; }

bool has_effect(const OptionRow& row, Method method) {
  return std::ranges::find(row.methods, method) != row.methods.end();
}

Json methods_json(const Limits& limits) {
  Json json = {{"methods", Json::array()}, {"presets", Json::array()}, {"options", Json::array()}};
  for (const PresetRow& row : kPresets) json["presets"].push_back(preset_json(row, limits));
  for (const MethodRow& row : kMethods) json["methods"].push_back(method_json(row));
  for (const OptionRow& row : option_table()) json["options"].push_back(option_json(row, limits));
  return json;
}

}  // namespace unwrapd::api
