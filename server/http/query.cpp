#include "server/http/query.hpp"

#include <algorithm>
#include <charconv>

#include "core/base/parse_number.hpp"
#include "server/base/errors.hpp"

namespace unwrapd::server::http {
namespace {

std::string decoded(std::string_view text) {
  constexpr std::size_t digits = 2;
  std::string plain;
  for (std::size_t at = 0; at < text.size(); ++at) {
    plain += text[at] == '+' ? ' ' : text[at];
    if (text[at] != '%' || text.size() - at <= digits) continue;
    unsigned char byte = 0;
    const char* first = text.data() + at + 1;
    if (std::from_chars(first, first + digits, byte, 16).ptr != first + digits) continue;
    plain.back() = static_cast<char>(byte);
    at += digits;
  }
  return plain;
}

}  // namespace

api::Query parse_query(std::string_view text) {
  api::Query query;
  while (!text.empty()) {
    const std::string_view parameter = text.substr(0, text.find('&'));
    text.remove_prefix(std::min(parameter.size() + 1, text.size()));
    if (parameter.empty()) continue;
    const std::string_view name = parameter.substr(0, parameter.find('='));
    query.emplace(decoded(name),
                  decoded(parameter.substr(std::min(name.size() + 1, parameter.size()))));
  }
  return query;
}

void refuse_unknown(const std::string& name) {
  refuse_option(name, "There is no parameter of this name here; see /openapi.yaml.");
}

void refuse_all(const Request& request) {
  if (!request.query.empty()) refuse_unknown(request.query.begin()->first);
}

void check_once(const api::Query& query, const std::string& name) {
  if (query.count(name) > 1) refuse_option(name, "The parameter is given twice; give it once.");
}

std::int64_t positive_number(const std::string& name, const std::string& text, std::int64_t most) {
  const auto number = parse_number<std::int64_t>(text);
  if (!number || *number < 1 || *number > most) {
    refuse_option(name, "The parameter " + name + " must be a number from 1 to " +
                            std::to_string(most) + "; correct it.");
  }
  return *number;
}

}  // namespace unwrapd::server::http
