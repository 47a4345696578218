#pragma once
// Options on the wire. One table says everything about an option; parsing (query and JSON), the
// answer of GET /v1/methods, the resolved options of a job and the client's flags all come from it.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/json.hpp"
#include "api/limits.hpp"
#include "core/options.hpp"

namespace unwrapd::api {

enum class OutputFormat { automatic, glb, gltf, obj };  ///< automatic: "auto", as it came in

struct JobOptions {
  UnwrapOptions unwrap;
  OutputFormat output = OutputFormat::automatic;
  /// Sentences for the report: options that were given but have no effect with this method. They
  /// are no part of the resolved options: whoever keeps a job keeps them beside its options.
  std::vector<std::string> notes;
};

enum class OptionType { choice, number, integer };

struct OptionRow {
  std::string_view name;  ///< on the wire; the flag is this with dashes
  OptionType type;
  std::span<const std::string_view> choices;  ///< of a choice, in the order of its enumerators
  double minimum;                             ///< of a number or integer
  std::optional<double> maximum;              ///< empty: none, or a Limit (see option_maximum())
  std::string_view description;               ///< one sentence
  std::span<const Method> methods;            ///< with which it has an effect

  /// The option in its wire type (a choice as its name), from and to the options.
  Json (*get)(const JobOptions&);
  void (*set)(JobOptions&, double);  ///< of a choice: its index
};

std::span<const OptionRow> option_table();

/// The row of this name, or nullptr.
const OptionRow* find_option(std::string_view name);

/// The default, as in JobOptions{}.
Json option_default(const OptionRow& row);

/// The highest value allowed, where there is one: iterations has the server's own.
std::optional<double> option_maximum(const OptionRow& row, const Limits& limits);

/// Whether the option changes anything with this method.
bool has_effect(const OptionRow& row, Method method);

std::string_view method_name(Method method);

using Query = std::multimap<std::string, std::string>;  ///< a decoded query string

/// Options of a query string; those not named keep their default. Throws Error{invalid_option}
/// with the pointer "/name" of the first option that is unknown, given twice, of the wrong type or
/// out of range.
JobOptions parse_options(const Query& query, const Limits& limits);

/// The same from a JSON object; a null lambda counts as not given, so that resolved options can be
/// sent again.
JobOptions parse_options(const Json& object, const Limits& limits);

/// The same from JSON text, strictly: also throws malformed_request for what is no JSON.
JobOptions parse_options_text(std::string_view text, const Limits& limits);

/// The resolved options, every default filled in; lambda is null unless the method is hybrid.
Json to_json(const JobOptions& options);

/// The body of GET /v1/methods: the methods, and every option with type, range and default.
Json methods_json(const Limits& limits);

}  // namespace unwrapd::api
