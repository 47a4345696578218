#include "server/http/form.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/error.hpp"
#include "server/base/utf8.hpp"

namespace unwrapd::server::http {
namespace {

constexpr std::string_view kCrLf = "\r\n";
constexpr std::string_view kPartHeadEnd = "\r\n\r\n";
constexpr std::string_view kDashes = "--";
constexpr std::string_view kBlanks = " \t";

[[noreturn]] void no_form(const std::string& what) {
  throw Error(ErrorCode::malformed_request, what);
}

[[noreturn]] void wrong_disposition() {
  no_form(
      "A part's Content-Disposition is not of the form \"form-data; name=\"...\"; "
      "filename=\"...\"\"; check the client.");
}

void skip_blanks(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
}

/// Removes and returns the text before the first of these characters.
std::string_view take_until(std::string_view& text, std::string_view ends) {
  const std::string_view taken = text.substr(0, text.find_first_of(ends));
  text.remove_prefix(taken.size());
  return taken;
}

/// A value in quotes, of which text has the first.
std::string take_quoted(std::string_view& text) {
  std::string value;
  for (text.remove_prefix(1); !text.empty() && text.front() != '"'; text.remove_prefix(1)) {
    const bool escapes = text.starts_with("\\\"") || text.starts_with("\\\\");
    if (escapes) text.remove_prefix(1);
    value += text.front();
  }
  if (text.empty()) wrong_disposition();
  text.remove_prefix(1);
  return value;
}

std::string take_value(std::string_view& text) {
  if (text.starts_with('"')) return take_quoted(text);
  return std::string(take_until(text, " \t;"));
}

/// What a disposition says so far.
struct Names {
  std::optional<std::string> name;
  std::optional<std::string> filename;
};

void put_once(std::optional<std::string>& place, const std::string& value) {
  if (place) wrong_disposition();
  place = value;
}

/// Removes one `key=value` from the beginning of the text.
void take_parameter(std::string_view& text, Names& names) {
  const std::string_view key = take_until(text, "= \t;\"");
  if (key.empty() || !text.starts_with('=')) wrong_disposition();
  text.remove_prefix(1);
  const std::string value = take_value(text);
  if (same_word(key, "name")) put_once(names.name, value);
  if (same_word(key, "filename")) put_once(names.filename, value);
}

/// The only Content-Disposition among the fields of a part's head, each of which follows a line
/// end.
std::string_view disposition_in(std::string_view head) {
  std::optional<std::string_view> found;
  while (!head.empty()) {
    head.remove_prefix(kCrLf.size());
    const std::string_view line = head.substr(0, head.find(kCrLf));
    head.remove_prefix(line.size());
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || !same_word(line.substr(0, colon), "Content-Disposition"))
      continue;
    if (found) no_form("A part has two Content-Dispositions; send one.");
    found = line.substr(colon + 1);
  }
  if (!found) no_form("A part has no Content-Disposition; give it one with a name.");
  return *found;
}

}  // namespace

Part part_of_disposition(std::string_view value) {
  if (std::ranges::any_of(value, is_control)) wrong_disposition();
  skip_blanks(value);
  if (!same_word(take_until(value, " \t;"), "form-data")) wrong_disposition();
  Names names;
  for (skip_blanks(value); !value.empty(); skip_blanks(value)) {
    if (value.front() != ';') wrong_disposition();
    value.remove_prefix(1);
    skip_blanks(value);
    if (!value.empty()) take_parameter(value, names);
  }
  if (!names.name) wrong_disposition();
  Part part{.name = *names.name, .filename = names.filename.value_or("")};
  if (!is_utf8_text(part.name) || !is_utf8_text(part.filename))
    no_form("The name of a part is not UTF-8; encode it as UTF-8.");
  return part;
}

FormParser::FormParser(std::string_view boundary, BodyReader::PartStart start,
                       BodyReader::Sink sink)
    : delimiter_(std::string(kCrLf) + std::string(kDashes) + std::string(boundary)),
      start_(std::move(start)),
      sink_(std::move(sink)) {
  if (boundary.empty() || boundary.size() > kMaxBoundary)
    no_form("The Content-Type has no boundary of up to 70 characters; check the client.");
}

void FormParser::feed(std::string_view bytes) {
  held_.append(bytes);
  while (step()) {
  }
  if (state_ == State::ended) held_.clear();
}

void FormParser::finish() const {
  if (state_ != State::ended) no_form("The form ends before its last boundary; check the client.");
}

/// False when more bytes are needed.
bool FormParser::step() {
  switch (state_) {
    case State::before:
    case State::in_part:
      return pass_to_delimiter();
    case State::after_delimiter:
      return choose_after_delimiter();
    case State::in_head:
      return read_head();
    case State::ended:
      break;
  }
  return false;
}

/// Keeps bytes that may begin a delimiter.
bool FormParser::pass_to_delimiter() {
  const std::size_t found = held_.find(delimiter_);
  if (found != std::string::npos) {
    hand_out(found);
    held_.erase(0, delimiter_.size());
    state_ = State::after_delimiter;
    return true;
  }
  const std::size_t last = std::min(held_.rfind('\r'), held_.size());  // it has no other one
  const bool begins = delimiter_.starts_with(std::string_view(held_).substr(last));
  hand_out(begins ? last : held_.size());
  return false;
}

void FormParser::hand_out(std::size_t count) {
  if (state_ == State::in_part && count > 0) sink_(std::string_view(held_).substr(0, count));
  held_.erase(0, count);
}

/// The last delimiter is followed by two dashes, the others by blanks and a line end.
bool FormParser::choose_after_delimiter() {
  if (held_.size() < 2) return false;
  if (held_.starts_with(kDashes)) {
    state_ = State::ended;
    return false;
  }
  const std::size_t end = held_.find_first_not_of(kBlanks);
  if (end == std::string::npos ? held_.size() > kMaxPartHead : end > kMaxPartHead)
    no_form("A boundary is followed by blanks without end; check the client.");
  if (end == std::string::npos || end + 2 > held_.size()) return false;
  if (held_.compare(end, 2, kCrLf) != 0)
    no_form("A boundary is not followed by the end of its line; check the client.");
  held_.erase(0, end);
  searched_ = 0;
  state_ = State::in_head;
  return true;
}

/// Begins with the line end before its first field.
bool FormParser::read_head() {
  const std::size_t end = held_.find(kPartHeadEnd, searched_);
  if (end == std::string::npos ? held_.size() > kMaxPartHead : end > kMaxPartHead)
    throw Error(ErrorCode::headers_too_large, "The head of a part exceeds 8 KiB; shorten it.");
  searched_ = held_.size() - std::min(held_.size(), kPartHeadEnd.size() - 1);
  if (end == std::string::npos) return false;
  start_(part_of_disposition(disposition_in(std::string_view(held_).substr(0, end))));
  held_.erase(0, end + kPartHeadEnd.size());
  state_ = State::in_part;
  return true;
}

}  // namespace unwrapd::server::http
