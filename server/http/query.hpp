#pragma once
// Parameters of a query: each once, each known, numbers in their range. What is wrong is
// Error{invalid_option} whose place is the parameter's name.

#include <cstdint>
#include <string>

#include "server/http/http.hpp"

namespace unwrapd::server::http {

[[noreturn]] void refuse_parameter(const std::string& name, const std::string& what);
[[noreturn]] void refuse_unknown(const std::string& name);
void check_once(const Request& request, const std::string& name);

/// A number from 1 to most.
std::int64_t positive_number(const std::string& name, const std::string& text, std::int64_t most);

}  // namespace unwrapd::server::http
