#include "api/json.hpp"

#include <cmath>
#include <limits>

#include "core/base/error.hpp"
#include "core/json/json.hpp"

namespace unwrapd::api {
namespace {

Error limit_error(const std::string& excess, std::size_t most, const std::string& unit) {
  return Error(ErrorCode::malformed_request, "The JSON " + excess + std::to_string(most) + unit);
}

Error request_error(const json::Refusal& refusal) {
  switch (refusal.fault) {
    case json::Fault::repeated_name:
      return Error(ErrorCode::invalid_option,
                   "\"" + refusal.name + "\" is given twice; give it once.", refusal.pointer);
    case json::Fault::number_range:
      return Error(ErrorCode::invalid_option, "A number is out of range: give a finite one.",
                   refusal.pointer);
    case json::Fault::too_many_members:
      return Error(ErrorCode::malformed_request,
                   "An object of the JSON has too many members: send at most " +
                       std::to_string(refusal.figure) + ".",
                   refusal.pointer);
    case json::Fault::too_long:
      return limit_error("is too long: send at most ", refusal.figure, " bytes.");
    case json::Fault::too_deep:
      return limit_error("is nested too deeply: use at most ", refusal.figure, " levels.");
    case json::Fault::too_many_values:
      return limit_error("has too many values: send at most ", refusal.figure, ".");
    default:  // the memory is bounded by the counts
      return Error(
          ErrorCode::malformed_request,
          "The text is not valid JSON: correct it at byte " + std::to_string(refusal.figure) + ".",
          "byte " + std::to_string(refusal.figure));
  }
}

}  // namespace

Json parse_json(std::string_view text, const JsonLimits& limits) {
  return json::read(text, {.error = request_error,
                           .max_bytes = limits.max_bytes,
                           .max_depth = static_cast<std::size_t>(limits.max_depth),
                           .max_values = limits.max_values,
                           .max_members = limits.max_members});
}

std::optional<std::int32_t> index_in(const Json& value) {
  const double number = value.is_number() ? value.get<double>() : -1;
  const bool is_index = number >= 0 && number <= std::numeric_limits<std::int32_t>::max() &&
                        std::trunc(number) == number;
  return is_index ? std::optional(static_cast<std::int32_t>(number)) : std::nullopt;
}

bool read_numbers(const Json& value, std::span<double> numbers) {
  if (!value.is_array() || value.size() != numbers.size()) return false;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!value[i].is_number() || !std::isfinite(value[i].get<double>())) return false;
    numbers[i] = value[i].get<double>();
  }
  return true;
}

double finite(double value) {
  if (std::isfinite(value)) return value;
  const double largest = std::numeric_limits<double>::max();
  return value < 0 ? -largest : largest;
}

std::string to_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string pointer_token(std::string_view text) { return json::pointer_token(text); }

}  // namespace unwrapd::api
