// A query is converted to a JSON object. Every member of an object is then found in the table,
// checked against its row and set. core's validate() checks rules that concern several options.
#include "api/options.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "api/edit_distance.hpp"
#include "api/option_values.hpp"
#include "core/base/error.hpp"
#include "core/types/chart_rules.hpp"

namespace unwrapd::api {
namespace {

constexpr std::size_t kMaxEchoed = 40;      // characters of a user's text in a message
constexpr std::size_t kMaxMisspelling = 2;  // edits between a name and the suggested one

[[noreturn]] void refuse(std::string_view name, const std::string& message) {
  throw Error(ErrorCode::invalid_option, message, option_pointer(name));
}

/// "iterations" of "stop.iterations"; of a name without a group, itself.
std::string_view last_part(std::string_view name) { return name.substr(name.rfind('.') + 1); }

[[noreturn]] void refuse_unknown(std::string_view name) {
  if (name.starts_with("webhook"))
    refuse(name, "A webhook is no option: send its address in the header Unwrapd-Webhook.");
  const std::string_view asked = name.substr(0, kMaxEchoed);
  const auto distance = [&](const OptionRow& row) {
    return std::min(edit_distance(asked, row.name), edit_distance(asked, last_part(row.name)));
  };
  const OptionRow& nearest = *std::ranges::min_element(option_table(), {}, distance);
  std::string advice = "the options are ";
  for (const OptionRow& row : option_table())
    advice += std::string(row.name) + (&row == &option_table().back() ? "." : ", ");
  if (distance(nearest) <= std::min(kMaxMisspelling, asked.size() / 2))
    advice = "did you mean " + std::string(nearest.name) + "?";
  refuse(name, "There is no option of this name: " + advice);
}

/// Whether this is the name of a group of options, such as stop.
bool is_group(std::string_view name) {
  return std::ranges::any_of(option_table(), [&](const OptionRow& row) {
    return row.name.size() > name.size() && row.name.starts_with(name) &&
           row.name[name.size()] == '.';
  });
}

constexpr std::string_view kPreset = "preset";

/// The preset that the object names, or the default.
Preset preset_of(const Json& object, const Limits& limits) {
  const auto named = object.find(kPreset);
  JobOptions options;
  options.preset = Preset::texture;
  if (named == object.end()) return options.preset;
  const OptionRow& row = *find_option(kPreset);
  check_value(row, *named, limits);
  row.set(options, *named);
  return options.preset;
}

/// A distance is a mode of its own in core; exact welding has no use for one.
void settle_welding(Welding& welding) {
  if (welding.mode == WeldMode::exact)
    welding.distance.reset();
  else
    welding.mode = welding.distance ? WeldMode::distance : WeldMode::automatic;
}

/// A density without a size asks for the size.
void settle_page(JobOptions& options, bool is_size_given) {
  if (!is_size_given && options.unwrap.packing.texels_per_unit &&
      options.asset.textures == TextureMode::keep)
    options.unwrap.page_fit = PageFit::multiple_of_four;
}

/// The least size of new textures, and what textures=transfer excludes: a texel of a new texture
/// belongs to one place of the surface, on the page.
void settle_textures(JobOptions& options) {
  const UnwrapOptions& unwrap = options.unwrap;
  options.asset.page = unwrap.page_size();
  if (options.asset.textures != TextureMode::transfer) return;
  const auto require = [](bool holds, const std::string& message) {
    if (!holds) refuse("textures", "textures=transfer " + message);
  };
  require(unwrap.repack_only || unwrap.guarantee == Guarantee::bijective,
          "needs guarantee=bijective: overlapping triangles would share texels.");
  require(unwrap.constraints.empty(),
          "needs places that packing keeps apart; leave out constraints.");
  require(!unwrap.measure_only, "paints images for other UVs; leave out measure_only.");
  require(!unwrap.finds_page(), "paints images of a given size; give resolution in texels.");
  require(unwrap.packing.max_pages == 1, "writes one page; leave out max_pages.");
  require(unwrap.packing.group == PageGroup::scene, "writes one page; leave out group.");
  require(!unwrap.packing.stack_identical,
          "needs a place for every island; leave out stack_identical.");
}

/// Options of which one takes the effect from others.
struct Excluder {
  std::string_view reason;
  bool (*is_on)(const JobOptions&);
  std::array<std::string_view, 6> excluded;

  [[nodiscard]] bool excludes(std::string_view name, const JobOptions& options) const {
    return std::ranges::find(excluded, name) != excluded.end() && is_on(options);
  }
};

using J = const JobOptions&;

constexpr std::array kExcluders = {
    Excluder{"with stop.iterations",
             [](J job) { return job.unwrap.stop.iterations.has_value(); },
             {"stop.tolerance", "stop.max_iterations"}},
    Excluder{"without compression=draco",
             [](J job) { return job.asset.compression != Compression::draco; },
             {"draco_bits"}},
    Excluder{"with width and height",
             [](J job) { return job.unwrap.width && job.unwrap.height; },
             {"resolution"}},
    Excluder{"with weld=exact",
             [](J job) { return job.unwrap.welding.mode == WeldMode::exact; },
             {"weld_distance"}},
    Excluder{"with measure_only, which packs nothing",
             [](J job) { return job.unwrap.measure_only; },
             {"padding", "rotation", "texels_per_unit", "group", "max_pages", "stack_identical"}},
    Excluder{"with repack_only and measure_only, which keep seams and the sizes of islands",
             [](J job) { return job.unwrap.keeps_uvs(); },
             {"seam_avoid", "keep_edges", "texel_density"}},
    Excluder{"with guarantee=none",
             [](J job) { return job.unwrap.guarantee == Guarantee::none; },
             {"repair"}},
    Excluder{"with constraints, which determine the charts and their places",
             [](J job) { return !job.unwrap.constraints.empty(); },
             {"max_charts", "effort", "symmetry", "texel_density"}},
    Excluder{"with a boundary shape, which every component gets as one chart",
             [](J job) { return shapes_boundary(job.unwrap); },
             {"max_charts", "symmetry"}},
};

/// The options so far, and the rows that were given.
struct PartialOptions {
  PartialOptions(Preset preset, const Limits& server)
      : limits(server), options(preset_options(preset)) {
    Stop& stop = options.unwrap.stop;
    stop.max_iterations = std::min(stop.max_iterations, limits.max_iterations);
    if (stop.iterations) stop.iterations = std::min(*stop.iterations, limits.max_iterations);
  }

  const Limits& limits;
  JobOptions options;
  std::vector<const OptionRow*> given;

  void add(const std::string& name, const Json& value) {
    const OptionRow* row = find_option(name);
    if (row == nullptr) refuse_unknown(name);
    const bool unsets = value.is_null() && row->nullable;
    if (!unsets) check_value(*row, value, limits);
    row->set(options, value);
    if (!unsets) given.push_back(row);
  }

  void add_group(const std::string& name, const Json& group) {
    if (!group.is_object())
      refuse(name, name + " must be an object with one member for each of its options.");
    for (const auto& [inner, value] : group.items())
      add(std::string(name).append(".") += inner, value);
  }

  void add_all(const Json& object) {
    for (const auto& [name, value] : object.items()) {
      if (is_group(name)) {
        add_group(name, value);
      } else if (find_option(name) != nullptr && name.find('.') != std::string::npos) {
        refuse(name,
               "In JSON, options with a dot are members of an object: write {\"stop\": {...}}.");
      } else {
        add(name, value);
      }
    }
  }

  /// Why an option has no effect with the others; empty if it has one.
  [[nodiscard]] std::string reason_against(const OptionRow& row) const {
    if (!has_effect(row, options.unwrap.method))
      return "with the method " + std::string(method_name(options.unwrap.method));
    const auto excluder = std::ranges::find_if(
        kExcluders, [&](const Excluder& one) { return one.excludes(row.name, options); });
    return excluder == kExcluders.end() ? "" : std::string(excluder->reason);
  }

  /// Whether the option is as it would be if it were not given. A lambda and the like always say
  /// something.
  [[nodiscard]] bool is_as_by_default(const OptionRow& row) const {
    const bool is_by_preset = row.name == "draco_bits" || row.name == "max_charts";
    return (!row.nullable || is_by_preset) &&
           row.get(options) == option_default(row, limits, options.preset);
  }

  [[nodiscard]] bool is_given(std::string_view name) const {
    return std::ranges::find(given, name, &OptionRow::name) != given.end();
  }

  JobOptions finish() {
    yield_to_request(options, [this](std::string_view name) { return is_given(name); });
    settle_welding(options.unwrap.welding);
    settle_page(options, is_given("resolution") || is_given("width") || is_given("height"));
    settle_textures(options);
    validate(options.unwrap, limits.max_iterations);
    for (const OptionRow* row : given) {
      const std::string reason = reason_against(*row);
      if (reason.empty() || is_as_by_default(*row)) continue;
      options.notes.push_back("The option " + std::string(row->name) + " has no effect " + reason +
                              ".");
    }
    return std::move(options);
  }
};

}  // namespace

void set_member(Json& object, std::string_view name, Json value) {
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos)
    object[std::string(name)] = std::move(value);
  else
    object[std::string(name.substr(0, dot))][std::string(name.substr(dot + 1))] = std::move(value);
}

std::string option_pointer(std::string_view name) {
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos || !is_group(name.substr(0, dot)))
    return "/" + pointer_token(name);
  return "/" + std::string(name.substr(0, dot)) + "/" + pointer_token(name.substr(dot + 1));
}

Json options_object(const Query& query) {
  Json object = Json::object();
  for (const auto& [name, text] : query) {
    const OptionRow* row = find_option(name);
    if (row == nullptr) refuse_unknown(name);
    if (query.count(name) > 1) refuse(name, name + " is given twice; give it once.");
    set_member(object, name, value_of_text(*row, text));
  }
  return object;
}

JobOptions parse_options(const Query& query, const Limits& limits) {
  return parse_options(options_object(query), limits);
}

JobOptions parse_options(const Json& object, const Limits& limits) {
  if (!object.is_object())
    throw Error(ErrorCode::invalid_option, "The options must be a JSON object.");
  PartialOptions gathering(preset_of(object, limits), limits);
  gathering.add_all(object);
  return gathering.finish();
}

JobOptions parse_stored_options(Json object) {
  if (object.is_object() && !object.contains(kPreset)) {  // earlier versions had no presets
    object[kPreset] = preset_name(Preset::chart);
    object.emplace("texcoord", 0);
  }
  if (object.is_object()) object.emplace("draco_bits", nullptr);  // Draco was lossless
  const auto plain_iterations = object.find("iterations");  // resolved options of version 0.1.0
  if (plain_iterations != object.end()) {
    object["stop"]["iterations"] = *plain_iterations;
    object.erase("iterations");
  }
  Limits any;
  any.max_iterations = any.max_constraints = std::numeric_limits<int>::max();
  return parse_options(object, any);
}

JobOptions parse_options_text(std::string_view text, const Limits& limits) {
  return parse_options(parse_json(text, {.max_bytes = kMaxOptionsBytes}), limits);
}

Json to_json(const JobOptions& options) {
  Json json = Json::object();
  for (const OptionRow& row : option_table()) set_member(json, row.name, row.get(options));
  if (options.unwrap.method != Method::hybrid) json["lambda"] = nullptr;
  return json;
}

}  // namespace unwrapd::api
