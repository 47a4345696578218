#include "contract_text.hpp"

#include <sstream>
#include <string_view>

#include "api/openapi.hpp"

namespace unwrapd::api {
namespace {

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in{std::string(text)};
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

std::size_t indent(const std::string& line) {
  const std::size_t first = line.find_first_not_of(' ');
  return first == std::string::npos ? std::string::npos : first;  // an empty line ends nothing
}

bool is_key(const std::string& line, std::size_t column, const std::string& key) {
  return indent(line) == column && line.compare(column, key.size() + 1, key + ":") == 0;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

/// The lines deeper than the key that stands in the column of lines.
std::vector<std::string> below(const std::vector<std::string>& lines, const std::string& key) {
  std::vector<std::string> found;
  const std::size_t column = lines.empty() ? 0 : indent(lines.front());
  bool inside = false;
  for (const std::string& line : lines) {
    if (indent(line) <= column) {
      inside = is_key(line, column, key);
    } else if (inside) {
      found.push_back(line);
    }
  }
  return found;
}

}  // namespace

std::vector<std::string> section(const std::vector<std::string>& path) {
  std::vector<std::string> lines = split(openapi_yaml(), '\n');
  for (const std::string& key : path) lines = below(lines, key);
  return lines;
}

std::vector<std::string> keys(const std::vector<std::string>& path) {
  const std::vector<std::string> lines = section(path);
  std::vector<std::string> names;
  for (const std::string& line : lines) {
    if (indent(line) != indent(lines.front())) continue;
    names.push_back(trimmed(line.substr(0, line.find(':'))));
  }
  return names;
}

std::string unquoted(const std::string& text) {
  const bool is_quoted = text.size() > 1 && text.front() == '\'' && text.back() == '\'';
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

std::string scalar(const std::vector<std::string>& path, const std::string& key) {
  const std::vector<std::string> lines = section(path);
  for (const std::string& line : lines) {
    if (is_key(line, indent(lines.front()), key)) return trimmed(line.substr(line.find(':') + 1));
  }
  return {};
}

std::vector<std::string> list(const std::vector<std::string>& path, const std::string& key) {
  std::vector<std::string> items;
  const std::string line = scalar(path, key);
  if (!line.empty() && line.front() != '&') {  // an anchor names what follows
    for (const std::string& item : split(line.substr(1, line.size() - 2), ',')) {
      items.push_back(unquoted(trimmed(item)));
    }
    return items;
  }
  std::vector<std::string> deeper = path;
  deeper.push_back(key);
  for (const std::string& item : section(deeper)) items.push_back(trimmed(item).substr(2));
  return items;
}

}  // namespace unwrapd::api
