#include "server/config/config_row.hpp"

#include "core/base/parse_number.hpp"

namespace unwrapd::server::config {

void expected(const std::string& what) { throw Error(ErrorCode::invalid_option, what); }

std::int64_t number_in(Range range, const std::string& text) {
  const auto number = parse_number<std::int64_t>(text);
  if (!number || *number < range.least || *number > range.most) {
    expected("a whole number from " + std::to_string(range.least) + " to " +
             std::to_string(range.most));
  }
  return *number;
}

bool on_or_off(const std::string& text) {
  if (text != "true" && text != "false") expected("true or false");
  return text == "true";
}

std::vector<std::string> split_list(const std::string& text) {
  constexpr const char* space = " \t";
  std::vector<std::string> items;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string item = text.substr(at, comma - at);
    const std::size_t first = item.find_first_not_of(space);
    if (first != std::string::npos)
      items.push_back(item.substr(first, item.find_last_not_of(space) - first + 1));
    at = comma + 1;
  }
  return items;
}

std::string join_list(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ",") + item;
  return text;
}

}  // namespace unwrapd::server::config
