#pragma once
// Options on the wire. One table says everything about an option; parsing (query and JSON), the
// answer of GET /v1/methods, the resolved options of a job and the client's flags all come from it.

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

struct JobOptions {
  UnwrapOptions unwrap;
  AssetOptions asset;
  OutputFormat output = OutputFormat::automatic;
  /// Sentences for the report: options that were given but have no effect with this method. They
  /// are no part of the resolved options: whoever keeps a job keeps them beside its options.
  std::vector<std::string> notes;
};

enum class OptionType {
  choice,
  flag,
  number,
  integer,
  numbers,  ///< a number, or a list of different ones: "1,2" in a query
  names,    ///< a list of strings: in a query parted by commas, or their JSON
  objects,  ///< a list of objects (constraints.hpp, seam_paths.hpp): their JSON in a query
};

inline constexpr std::size_t kMaxNumbers = 32;  ///< entries of an option of type numbers

/// An option. In JSON "stop.iterations" is the member iterations of the object stop.
struct OptionRow {
  std::string_view name;  ///< on the wire; the flag is this with dashes for "_" and "."
  OptionType type;
  std::span<const std::string_view> choices = {};  ///< of a choice, in the order of its enumerators
  double minimum = 0;                              ///< of a number
  std::optional<double> maximum = {};              ///< of a number; empty: none, or the server's
  int Limits::*limit = nullptr;  ///< the server's own maximum, of a number or of a list's entries
  bool nullable = false;         ///< null counts as not given
  std::string_view description;  ///< what each value does, and when to choose it
  std::span<const Method> methods;  ///< with which it has an effect

  /// The option as JSON, from and to the options; set() takes what check_value() lets pass.
  Json (*get)(const JobOptions&);
  void (*set)(JobOptions&, const Json&);
};

std::span<const OptionRow> option_table();

/// The row of this name, or nullptr.
const OptionRow* find_option(std::string_view name);

/// Where an option stands in JSON: "/stop/iterations" for "stop.iterations".
std::string option_pointer(std::string_view name);

/// The row that a pointer leads to or into ("/constraints/2/uv"), or nullptr.
const OptionRow* option_at(std::string_view pointer);

/// What an option is when it is not given, on a server of these limits.
Json option_default(const OptionRow& row, const Limits& limits);

/// The highest number allowed, where there is one.
std::optional<double> option_maximum(const OptionRow& row, const Limits& limits);

/// Whether the option changes anything with this method.
bool has_effect(const OptionRow& row, Method method);

std::string_view method_name(Method method);

using Query = std::multimap<std::string, std::string>;  ///< a decoded query string

/// A query as the JSON object that says the same. Text that is none of its option's type stays a
/// string. Throws Error{invalid_option} for an option that is unknown or given twice.
Json options_object(const Query& query);

/// Options of a query string; those not named keep their default. Throws Error{invalid_option}
/// with the pointer "/name" of the first option that is unknown, given twice, of the wrong type or
/// out of range.
JobOptions parse_options(const Query& query, const Limits& limits);

/// The same from a JSON object; null counts as not given where an option can be null in resolved
/// options, so that these can be sent again.
JobOptions parse_options(const Json& object, const Limits& limits);

/// The same from JSON text, strictly: also throws malformed_request for what is no JSON.
JobOptions parse_options_text(std::string_view text, const Limits& limits);

/// Resolved options that were accepted once: by a server of any limits, by any version since 0.1.0.
JobOptions parse_stored_options(Json object);

/// The longest JSON text of options that is read: room for as many constraints as may be given.
inline constexpr std::size_t kMaxOptionsBytes = std::size_t{16} * 1024 * 1024;

/// The resolved options, every default filled in; lambda is null unless the method is hybrid.
Json to_json(const JobOptions& options);

/// The body of GET /v1/methods: the methods, and every option with type, range and default.
Json methods_json(const Limits& limits);

}  // namespace unwrapd::api
