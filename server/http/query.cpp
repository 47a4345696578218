#include "server/http/query.hpp"

#include <charconv>

namespace unwrapd::server::http {

void refuse_parameter(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::invalid_option, what, "/" + name);
}

void refuse_unknown(const std::string& name) {
  refuse_parameter(name, "There is no parameter of this name here; see /openapi.yaml.");
}

void check_once(const Request& request, const std::string& name) {
  if (request.query.count(name) > 1)
    refuse_parameter(name, "The parameter is given twice; give it once.");
}

std::int64_t positive_number(const std::string& name, const std::string& text, std::int64_t most) {
  std::int64_t number = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end || number < 1 || number > most) {
    refuse_parameter(name, "The parameter " + name + " must be a number from 1 to " +
                               std::to_string(most) + "; correct it.");
  }
  return number;
}

}  // namespace unwrapd::server::http
