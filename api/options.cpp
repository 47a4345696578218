// Text or JSON becomes a value in three steps that are the same for every option: find the row,
// read the value as the row's type, check the row's range. core's validate() then checks what
// concerns more than one option.
#include "api/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/error.hpp"

namespace unwrapd::api {
namespace {

constexpr std::size_t kMaxEchoed = 40;      // characters of a user's text in a message
constexpr std::size_t kMaxMisspelling = 2;  // edits between a name and what was meant

[[noreturn]] void refuse(std::string_view name, const std::string& message) {
  throw Error(ErrorCode::invalid_option, message, "/" + pointer_token(name));
}

std::string listed(std::span<const std::string_view> names) {
  std::string text;
  for (const std::string_view name : names) {
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

/// "1" for 1, "0.5" for 0.5.
std::string plain(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

/// The number of single-character edits that turn a into b.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

[[noreturn]] void refuse_unknown(std::string_view name) {
  const std::string_view asked = name.substr(0, kMaxEchoed);
  std::vector<std::string_view> names;
  for (const OptionRow& row : option_table()) names.push_back(row.name);
  const auto distance = [&](std::string_view other) { return edit_distance(asked, other); };
  const auto nearest = std::ranges::min_element(names, {}, distance);
  const bool is_near = distance(*nearest) <= std::min(kMaxMisspelling, asked.size() / 2);
  const std::string advice = is_near ? "did you mean " + std::string(*nearest) + "?"
                                     : "the options are " + listed(names) + ".";
  refuse(name, "There is no option of this name: " + advice);
}

/// What a value of this option must be: "between 1 and 10000".
std::string allowed(const OptionRow& row, const Limits& limits) {
  if (row.type == OptionType::choice) return "one of " + listed(row.choices);
  const std::string kind = row.type == OptionType::integer ? "an integer" : "a finite number";
  const std::optional<double> maximum = option_maximum(row, limits);
  if (!maximum) return kind + " of at least " + plain(row.minimum);
  return kind + " between " + plain(row.minimum) + " and " + plain(*maximum);
}

bool in_range(const OptionRow& row, double value, const Limits& limits) {
  const double maximum = option_maximum(row, limits).value_or(std::numeric_limits<double>::max());
  return value >= row.minimum && value <= maximum;  // false for NaN
}

std::optional<double> choice_index(const OptionRow& row, std::string_view text) {
  const auto found = std::ranges::find(row.choices, text);
  if (found == row.choices.end()) return std::nullopt;
  return static_cast<double>(found - row.choices.begin());
}

template <class T>
std::optional<double> whole_number(std::string_view text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return static_cast<double>(value);
}

/// Text as the row's type; empty when it is none.
std::optional<double> value_of(const OptionRow& row, const std::string& text) {
  switch (row.type) {
    case OptionType::choice:
      return choice_index(row, text);
    case OptionType::integer:
      return whole_number<std::int64_t>(text);
    case OptionType::number:
      return whole_number<double>(text);
  }
  return std::nullopt;
}

/// JSON as the row's type; 10.0 is an integer, as JSON Schema has it.
std::optional<double> value_of(const OptionRow& row, const Json& json) {
  if (row.type == OptionType::choice) {
    if (!json.is_string()) return std::nullopt;
    return choice_index(row, json.get_ref<const std::string&>());
  }
  if (!json.is_number()) return std::nullopt;
  const double value = json.get<double>();
  if (row.type == OptionType::integer && std::trunc(value) != value) return std::nullopt;
  return value;
}

/// Options as they are gathered: the values so far and which were given.
struct Gathering {
  explicit Gathering(const Limits& server) : limits(server) {
    Stop& stop = options.unwrap.stop;
    stop.max_iterations = std::min(stop.max_iterations, limits.max_iterations);
  }

  const Limits& limits;
  JobOptions options;
  std::vector<const OptionRow*> given;

  void add(std::string_view name, const auto& raw) {
    const OptionRow* row = find_option(name);
    if (row == nullptr) refuse_unknown(name);
    if (std::ranges::find(given, row) != given.end()) {
      refuse(name, std::string(name) + " is given twice: give it once.");
    }
    const std::optional<double> value = value_of(*row, raw);
    const bool fits = value && (row->type == OptionType::choice || in_range(*row, *value, limits));
    if (!fits) refuse(name, std::string(name) + " must be " + allowed(*row, limits) + ".");
    row->set(options, *value);
    given.push_back(row);
  }

  JobOptions finish() {
    validate(options.unwrap, limits.max_iterations);
    const Json resolved = to_json(options);
    for (const OptionRow* row : given) {
      if (has_effect(*row, options.unwrap.method)) continue;
      if (resolved.at(std::string(row->name)) == option_default(*row)) continue;
      options.notes.push_back("The option " + std::string(row->name) +
                              " has no effect with the method " +
                              std::string(method_name(options.unwrap.method)) + ".");
    }
    return std::move(options);
  }
};

}  // namespace

JobOptions parse_options(const Query& query, const Limits& limits) {
  Gathering gathering(limits);
  for (const auto& [name, text] : query) gathering.add(name, text);
  return gathering.finish();
}

JobOptions parse_options(const Json& object, const Limits& limits) {
  if (!object.is_object()) {
    throw Error(ErrorCode::invalid_option, "The options must be a JSON object.");
  }
  Gathering gathering(limits);
  for (const auto& [name, value] : object.items()) {
    if (value.is_null() && name == "lambda") continue;  // as in resolved options
    gathering.add(name, value);
  }
  return gathering.finish();
}

JobOptions parse_options_text(std::string_view text, const Limits& limits) {
  return parse_options(parse_json(text), limits);
}

}  // namespace unwrapd::api
