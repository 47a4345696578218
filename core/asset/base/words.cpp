#include "core/asset/base/words.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace unwrapd::asset {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

bool is_continued(std::string_view text, std::size_t line_end) {
  std::size_t end = line_end;
  if (end > 0 && text[end - 1] == '\r') --end;
  return end > 0 && text[end - 1] == '\\';
}

}  // namespace

Statement statement_at(std::string_view text, std::size_t begin) {
  std::size_t line_end = begin, comment = std::string_view::npos;
  for (std::size_t line = begin;; line = line_end + 1) {
    line_end = std::min(text.find('\n', line), text.size());
    comment = text.substr(line, line_end - line).find('#');
    if (comment != std::string_view::npos) comment += line;
    const bool is_last = line_end == text.size() || comment != std::string_view::npos;
    if (is_last || !is_continued(text, line_end)) break;
  }
  std::size_t end = std::min(comment, line_end);
  while (end > begin && is_space(text[end - 1])) --end;
  return {begin, end, std::min(line_end + 1, text.size())};
}

std::string_view Words::next() {
  while (!rest_.empty() && is_gap(rest_.front())) rest_.remove_prefix(1);
  std::size_t size = 0;
  while (size < rest_.size() && !is_gap(rest_[size])) ++size;
  const std::string_view word = rest_.substr(0, size);
  rest_.remove_prefix(size);
  return word;
}

std::string_view Words::rest() const {
  std::string_view rest = rest_;
  while (!rest.empty() && is_gap(rest.front())) rest.remove_prefix(1);
  while (!rest.empty() && is_gap(rest.back())) rest.remove_suffix(1);
  return rest;
}

bool Words::is_gap(char c) { return is_space(c) || c == '\n' || c == '\\'; }

std::optional<double> number_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range)  // too large, or too small to matter
    return std::strtod(std::string(word).c_str(), nullptr);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::int64_t replace_lone_returns(std::string& text) {
  std::int64_t count = 0;
  for (std::size_t at = text.find('\r'); at != std::string::npos; at = text.find('\r', at)) {
    const std::size_t end = std::min(text.find_first_not_of('\r', at), text.size());
    const bool ends_in_lf = end < text.size() && text[end] == '\n';
    if (!ends_in_lf) {
      std::fill(text.begin() + std::ptrdiff_t(at), text.begin() + std::ptrdiff_t(end), '\n');
      count += static_cast<std::int64_t>(end - at);
    }
    at = end;
  }
  return count;
}

}  // namespace unwrapd::asset
