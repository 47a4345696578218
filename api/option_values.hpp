#pragma once
// Values of options: text as JSON of the option's type, and JSON checked against its row.

#include <string>
#include <string_view>

#include "api/options.hpp"

namespace unwrapd::api {

/// Text of a query as the row's type: "1,2" is a list for numbers. Text that is none of this type
/// stays a string, which check_value() refuses. Throws Error{invalid_option} for constraints in
/// which a member is given twice.
Json value_of_text(const OptionRow& row, const std::string& text);

/// Throws Error{invalid_option} with the option's pointer unless the value is of the row's type and
/// range; its message says what is allowed.
void check_value(const OptionRow& row, const Json& value, const Limits& limits);

}  // namespace unwrapd::api
