#include "core/asset/mesh_files/text_reader.hpp"

#include <algorithm>

#include "core/asset/base/words.hpp"
#include "core/asset/mesh_files/mesh_file.hpp"
#include "core/base/parse_number.hpp"

namespace unwrapd::asset::mesh_files {
namespace {

bool is_line_end(char c) { return c == '\n' || c == '\r'; }

bool is_gap(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || is_line_end(c); }

std::string shown(std::string_view word) {
  return word.empty() ? "the file ends"
                      : "\"" + std::string(word.substr(0, kShownBytes)) + "\" stands";
}

}  // namespace

std::string line_of_byte(std::string_view text, std::size_t byte) {
  std::size_t lines = 1;
  for (std::size_t i = 0; i < std::min(byte, text.size()); ++i)
    lines += text[i] == '\n' || (text[i] == '\r' && text.substr(i + 1, 1) != "\n") ? 1 : 0;
  return "line " + std::to_string(lines);
}

std::size_t start_of_text(std::string_view file) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  return file.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
}

void TextReader::refuse(const std::string& message) const { refuse_mesh(message, place()); }

void TextReader::skip_spaces() {
  while (next_ < text_.size()) {
    if (comment_ != '\0' && text_[next_] == comment_) {
      skip_line();
    } else if (is_gap(text_[next_])) {
      ++next_;
      pace_.add(1);
    } else {
      return;
    }
  }
}

std::string_view TextReader::next() {
  skip_spaces();
  word_ = next_;
  while (next_ < text_.size() && !is_gap(text_[next_])) ++next_;
  pace_.add(1 + (next_ - word_) / 16);
  return text_.substr(word_, next_ - word_);
}

bool TextReader::skip_line() {
  const std::size_t begin = next_;
  while (next_ < text_.size() && !is_line_end(text_[next_])) ++next_;
  pace_.add(1 + (next_ - begin) / 16);
  const auto* first = std::find_if_not(text_.begin() + begin, text_.begin() + next_, is_gap);
  return first != text_.begin() + next_ && (comment_ == '\0' || *first != comment_);
}

std::string_view TextReader::rest_of_line() {
  const std::size_t begin = next_;
  skip_line();
  const std::string_view rest = text_.substr(begin, next_ - begin);
  return comment_ == '\0' ? rest : rest.substr(0, rest.find(comment_));
}

double TextReader::number() {
  const std::string_view word = next();
  const std::optional<double> value = number_in(word);
  if (!value) refuse("a number is expected where " + shown(word));
  return *value;
}

std::int64_t TextReader::whole(std::int64_t least, std::int64_t most) {
  std::string_view word = next();
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto value = parse_number<std::int64_t>(word);
  if (!value || *value < least || *value > most)
    refuse("a whole number from " + std::to_string(least) + " to " + std::to_string(most) +
           " is expected where " + shown(word));
  return *value;
}

}  // namespace unwrapd::asset::mesh_files
