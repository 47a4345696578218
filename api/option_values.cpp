#include "api/option_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/parse_number.hpp"

namespace unwrapd::api {
namespace {

constexpr std::string_view kUnset = "none";  // null in JSON

/// The text as a number if all of it is one; else as a string.
template <class Number>
Json number_of(std::string_view text) {
  const std::optional<Number> value = parse_number<Number>(text);
  const bool fits = value && std::isfinite(static_cast<double>(*value));
  return fits ? Json(*value) : Json(text);
}

Json numbers_of(std::string_view text) {
  Json list = Json::array();
  while (true) {
    const std::size_t comma = text.find(',');
    list.push_back(number_of<double>(text.substr(0, comma)));
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  return list.size() == 1 ? list[0] : list;
}

/// Parses JSON; other text becomes a string.
Json json_of(const std::string& text) {
  try {
    return parse_json(text, {.max_bytes = kMaxOptionsBytes});
  } catch (const Error& error) {
    if (error.code() != ErrorCode::malformed_request) throw;
    return text;
  }
}

/// "a,b" as ["a", "b"]; names that contain commas must be given as JSON.
Json names_of(const std::string& text) {
  if (text.starts_with('[')) return json_of(text);
  Json list = Json::array();
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    list.push_back(text.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return list;
}

/// "1" for 1, "0.5" for 0.5.
std::string plain(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string join_names(std::span<const std::string_view> names) {
  std::string text;
  for (const std::string_view name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

/// The allowed values of this option: "an integer between 1 and 10000".
std::string allowed_values(const OptionRow& row, const Limits& limits) {
  if (row.type == OptionType::choice) return "one of " + join_names(row.choices);
  if (row.type == OptionType::flag) return "true or false";
  if (row.type == OptionType::text)
    return "a name of 1 to " + std::to_string(kMaxTextBytes) + " bytes, or none (null in JSON)";
  if (row.type == OptionType::names)
    return "a list of at most " + std::to_string(kMaxNames) + " strings";
  const std::string kind = row.type == OptionType::integer ? "an integer" : "a finite number";
  const std::optional<double> maximum = option_maximum(row, limits);
  std::string text = kind + (maximum ? " between " + plain(row.minimum) + " and " + plain(*maximum)
                                     : " of at least " + plain(row.minimum));
  if (row.type == OptionType::integer && !row.choices.empty())
    text += ", or one of " + join_names(row.choices);
  if (can_unset(row)) text += ", or none (null in JSON)";
  if (row.type == OptionType::numbers)
    text += ", or a list of at most " + std::to_string(kMaxNumbers) + " different ones";
  return text;
}

/// Whether value is a number in the row's range; 10.0 is an integer, as in JSON Schema.
bool is_number_of(const OptionRow& row, const Json& value, const Limits& limits) {
  if (!value.is_number()) return false;
  const double figure = value.get<double>();
  if (row.type == OptionType::integer && std::trunc(figure) != figure) return false;
  const double maximum = option_maximum(row, limits).value_or(std::numeric_limits<double>::max());
  return figure >= row.minimum && figure <= maximum;  // false for NaN
}

bool is_choice_of(const OptionRow& row, const Json& value) {
  return value.is_string() &&
         std::ranges::find(row.choices, value.get_ref<const std::string&>()) != row.choices.end();
}

bool is_list_of(const OptionRow& row, const Json& value, const Limits& limits) {
  if (!value.is_array() || value.empty() || value.size() > kMaxNumbers) return false;
  const auto fits = [&](const Json& entry) { return is_number_of(row, entry, limits); };
  if (!std::ranges::all_of(value, fits)) return false;
  auto figures = value.get<std::vector<double>>();
  std::ranges::sort(figures);
  return std::ranges::adjacent_find(figures) == figures.end();
}

bool is_text(const Json& value) {
  if (!value.is_string()) return false;
  const std::size_t bytes = value.get_ref<const std::string&>().size();
  return bytes > 0 && bytes <= kMaxTextBytes;
}

bool is_name_list(const Json& value) {
  const auto is_name = [](const Json& entry) { return entry.is_string(); };
  return value.is_array() && value.size() <= kMaxNames && std::ranges::all_of(value, is_name);
}

/// Throws the first fault, with its pointer.
void check_objects(const OptionRow& row, const Json& value, const Limits& limits) {
  const auto most = static_cast<std::size_t>(limits.*row.limit);
  if (value.is_array() && value.size() > most)
    throw Error(ErrorCode::invalid_option,
                std::string(row.name) + " must have at most " + std::to_string(most) + " entries.",
                option_pointer(row.name));
  JobOptions unused;
  row.set(unused, value);
}

/// Why a format that is read is not written.
std::string reason_against(const OptionRow& row, const Json& value) {
  if (row.name != "output" || !value.is_string()) return {};
  if (value == "stl" || value == "off") return ": this format holds no texture coordinates";
  return value == "ply" ? ": this format holds no texture coordinates for seams" : "";
}

bool fits(const OptionRow& row, const Json& value, const Limits& limits) {
  switch (row.type) {
    case OptionType::choice:
      return is_choice_of(row, value);
    case OptionType::flag:
      return value.is_boolean();
    case OptionType::text:
      return is_text(value);
    case OptionType::names:
      return is_name_list(value);
    case OptionType::number:
    case OptionType::integer:
      return is_choice_of(row, value) || is_number_of(row, value, limits);
    case OptionType::numbers:
      return is_number_of(row, value, limits) || is_list_of(row, value, limits);
    case OptionType::objects:
      check_objects(row, value, limits);
      return true;
  }
  return false;
}

}  // namespace

Json value_of_text(const OptionRow& row, const std::string& text) {
  if (can_unset(row) && text == kUnset) return nullptr;
  switch (row.type) {
    case OptionType::choice:
    case OptionType::text:
      return text;
    case OptionType::flag:
      return text == "true" || text == "false" ? Json(text == "true") : Json(text);
    case OptionType::names:
      return names_of(text);
    case OptionType::integer:
      return number_of<std::int64_t>(text);
    case OptionType::number:
      return number_of<double>(text);
    case OptionType::numbers:
      return numbers_of(text);
    case OptionType::objects:
      return json_of(text);
  }
  return text;
}

void check_value(const OptionRow& row, const Json& value, const Limits& limits) {
  if (fits(row, value, limits)) return;
  throw Error(ErrorCode::invalid_option,
              std::string(row.name) + " must be " + allowed_values(row, limits) +
                  reason_against(row, value) + ".",
              option_pointer(row.name));
}

}  // namespace unwrapd::api
