#pragma once
// Options of the API. One table describes every option; parsing (query and JSON), the answer of GET
// /v1/methods, the resolved options of a job and the client's flags all use it.

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/json.hpp"
#include "api/limits.hpp"
#include "core/types/asset_options.hpp"
#include "core/types/options.hpp"

namespace unwrapd::api {

enum class OutputFormat { automatic, glb, gltf, obj };  ///< automatic: "auto", as it came in

/// What the result is for. A preset sets several options, see set_preset().
enum class Preset { texture, lightmap, chart, paper };

struct JobOptions {
  Preset preset = Preset::chart;
  UnwrapOptions unwrap;
  AssetOptions asset;
  OutputFormat output = OutputFormat::automatic;
  /// Notes for the report about options that were given but have no effect with this method. They
  /// are not part of the resolved options; a stored job stores them separately.
  std::vector<std::string> notes;
};

enum class OptionType {
  choice,
  flag,
  number,
  integer,
  numbers,  ///< a number, or a list of different ones: "1,2" in a query
  text,     ///< a name, or null
  names,    ///< a list of strings: in a query separated by commas, or as JSON
  objects,  ///< a list of objects (constraints.hpp, seam_paths.hpp): in a query as JSON
};

inline constexpr std::size_t kMaxTextBytes = 200;  ///< of an option of type text
inline constexpr std::size_t kMaxNumbers = 32;     ///< entries of an option of type numbers

/// An option. In JSON "stop.iterations" is the member iterations of the object stop.
struct OptionRow {
  std::string_view name;  ///< on the wire; the flag is this with dashes for "_" and "."
  OptionType type;
  /// Of a choice, in the order of its enumerators; of an integer, words that may take its place.
  std::span<const std::string_view> choices = {};
  double minimum = 0;                  ///< of a number
  std::optional<double> maximum = {};  ///< of a number; empty: none, or the server's
  int Limits::*limit = nullptr;     ///< the server's own maximum of a number or of a list's length
  bool nullable = false;            ///< may be null, see can_unset()
  std::string_view description;     ///< what each value does, and when to choose it
  std::span<const Method> methods;  ///< methods with which it has an effect

  /// Read and write the option as JSON; set() expects a value that passed check_value().
  Json (*get)(const JobOptions&);
  void (*set)(JobOptions&, const Json&);
};

std::span<const OptionRow> option_table();

/// The row of this name, or null.
const OptionRow* find_option(std::string_view name);

/// Sets an option's member of an object: stop.iterations is the member iterations of stop.
void set_member(Json& object, std::string_view name, Json value);

/// The JSON pointer of an option: "/stop/iterations" for "stop.iterations".
std::string option_pointer(std::string_view name);

/// The row that a pointer leads to or into ("/constraints/2/uv"), or null.
const OptionRow* option_at(std::string_view pointer);

/// The default of an option on a server with these limits: what the preset sets.
Json option_default(const OptionRow& row, const Limits& limits, Preset preset = Preset::texture);

/// The highest allowed number, if there is one.
std::optional<double> option_maximum(const OptionRow& row, const Limits& limits);

/// Whether null in JSON, and none in a query, unset the option. A lambda always has a value; null
/// is only what resolved options have in its place for other methods than hybrid.
bool can_unset(const OptionRow& row);

/// Whether the option has an effect with this method.
bool has_effect(const OptionRow& row, Method method);

std::string_view method_name(Method method);

using Query = std::multimap<std::string, std::string>;  ///< a decoded query string

/// Converts a query to a JSON object. Text that does not fit its option's type stays a string.
/// Throws Error{invalid_option} for an option that is unknown or given twice.
Json options_object(const Query& query);

/// The options of a preset. They suit the shapes of most requests; what a request asks for may
/// exclude some of them, see yield_to_request().
JobOptions preset_options(Preset preset);

/// Changes options that come from the preset where the request excludes them: constraints, boundary
/// shapes that the method has, and repack_only keep charts whole and where they are. is_given tells
/// whether the request names an option.
void yield_to_request(JobOptions& options, const std::function<bool(std::string_view)>& is_given);

std::string_view preset_name(Preset preset);

/// The options of a query; options that are not given have the default of their preset. Throws
/// Error{invalid_option} with the pointer "/name" of the first option that is unknown, given twice,
/// of the wrong type or out of range.
JobOptions parse_options(const Query& query, const Limits& limits);

/// The same from a JSON object. null unsets an option that can be null in resolved options, so that
/// these can be sent again.
JobOptions parse_options(const Json& object, const Limits& limits);

/// The same from JSON text, strictly: also throws malformed_request if it is not JSON.
JobOptions parse_options_text(std::string_view text, const Limits& limits);

/// Reads resolved options that any server of any version since 0.1.0 accepted, whatever its limits.
/// Those of versions without presets are of the preset chart.
JobOptions parse_stored_options(Json object);

/// The longest JSON text of options that is read; enough for the maximal number of constraints.
inline constexpr std::size_t kMaxOptionsBytes = std::size_t{16} * 1024 * 1024;

/// The resolved options, with all defaults; lambda is null unless the method is hybrid.
Json to_json(const JobOptions& options);

/// The body of GET /v1/methods: the methods, the presets, and every option with type, range and
/// default.
Json methods_json(const Limits& limits);

}  // namespace unwrapd::api
