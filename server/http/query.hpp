#pragma once
// The parameters of a query. Calls check theirs here: each once, each known, numbers in their
// range. What is wrong is Error{invalid_option} whose place is the parameter's name.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "api/options.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::http {

/// "a=b&c" as names and values, percent-decoded (application/x-www-form-urlencoded in the URL
/// standard, 5.1): "+" is a space, the first "=" ends a name, "&&" holds no parameter, and a name
/// may be empty. A percent sign without two digits stays.
api::Query parse_query(std::string_view text);

[[noreturn]] void refuse_unknown(const std::string& name);
/// For calls without parameters.
void refuse_all(const Request& request);
void check_once(const api::Query& query, const std::string& name);

/// A number from 1 to most.
std::int64_t positive_number(const std::string& name, const std::string& text, std::int64_t most);

}  // namespace unwrapd::server::http
