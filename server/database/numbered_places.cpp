#include "server/database/numbered_places.hpp"

#include <cctype>

namespace unwrapd::server::database {

std::string with_dollars(std::string_view sql) {
  std::string text;
  int next = 0;
  bool in_quotes = false;
  for (std::size_t at = 0; at < sql.size(); ++at) {
    const char c = sql[at];
    if (c == '\'') in_quotes = !in_quotes;
    if (c != '?' || in_quotes) {
      text += c;
      continue;
    }
    text += '$';
    const bool is_numbered =
        at + 1 < sql.size() && std::isdigit(static_cast<unsigned char>(sql[at + 1])) != 0;
    if (!is_numbered) text += std::to_string(++next);
  }
  return text;
}

}  // namespace unwrapd::server::database
