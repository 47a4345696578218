#pragma once
// The text of an OBJ: statements, words, numbers.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace unwrapd::asset {

/// Bytes of a statement. Comment and line end are not part of it.
struct Statement {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t next = 0;  ///< where the next line begins
};

/// The statement that begins at this byte. A backslash before a line's end joins it with the next,
/// but not in a comment, which may well end in the path of a folder.
Statement statement_at(std::string_view text, std::size_t begin);

/// The words of a statement; the backslash and the line end of a continuation are spaces.
class Words {
 public:
  explicit Words(std::string_view statement) : rest_(statement) {}

  /// Empty at the end.
  std::string_view next();

 private:
  static bool is_gap(char c);
  std::string_view rest_;
};

/// The number that the whole word is, infinite or NaN where it says so.
std::optional<double> number_in(std::string_view word);

/// Line ends of old Macs, CR alone, become LF; CR before LF stays. Returns how many there were.
std::int64_t replace_lone_returns(std::string& text);

}  // namespace unwrapd::asset
