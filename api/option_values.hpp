#pragma once
// Values of options: converts text to JSON of the option's type, and checks JSON against its row.

#include <string>
#include <string_view>

#include "api/options.hpp"

namespace unwrapd::api {

/// The text of a query as a value of the row's type: "1,2" is a list for numbers. Text that does
/// not fit the type stays a string, which check_value() refuses. Throws Error{invalid_option} for
/// constraints with a duplicate member.
Json value_of_text(const OptionRow& row, const std::string& text);

/// Throws Error{invalid_option} with the option's pointer unless the value has the row's type and
/// range; the message names the allowed values.
void check_value(const OptionRow& row, const Json& value, const Limits& limits);

}  // namespace unwrapd::api
