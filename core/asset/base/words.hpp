#pragma once
// Statements, words and numbers of the formats that are lines of text: OBJ, MTL, PLY, OFF, STL.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace unwrapd::asset {

/// The bytes of a statement, without comment and line end.
struct Statement {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t next = 0;  ///< the start of the next line
};

/// The statement that starts at this byte. A backslash before a line's end joins it with the next,
/// but not in a comment, which may end in a path with a backslash.
Statement statement_at(std::string_view text, std::size_t begin);

/// The words of a statement; the backslash and the line end of a continuation are spaces.
class Words {
 public:
  explicit Words(std::string_view statement) : rest_(statement) {}

  /// Empty at the end.
  std::string_view next();

  /// All that is left, without the spaces around it.
  [[nodiscard]] std::string_view rest() const;

 private:
  static bool is_gap(char c);
  std::string_view rest_;
};

/// The value of the whole word, which may be infinite or NaN; empty if it is no number.
std::optional<double> number_in(std::string_view word);

/// Replaces line ends of old Macs, CR alone, by LF; CR before LF stays. Returns their number.
std::int64_t replace_lone_returns(std::string& text);

}  // namespace unwrapd::asset
