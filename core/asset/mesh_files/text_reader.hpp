#pragma once
// The words of a text of geometry (STL, PLY, OFF), one after another.

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/asset/base/pace.hpp"

namespace unwrapd::asset::mesh_files {

inline constexpr std::size_t kShownBytes = 40;  ///< of a word that a message repeats

/// The line, from 1 upwards, of a byte. A line ends in LF, CR LF or CR.
std::string line_of_byte(std::string_view text, std::size_t byte);

/// The byte after a byte order mark of UTF-8, if there is one.
std::size_t start_of_text(std::string_view file);

/// Reads words that spaces or line ends separate. Errors name the line of the latest word. Throws
/// Error{cancelled} from every reading function.
class TextReader {
 public:
  /// begin: the byte to start at; lines count from the start of the text. comment: a word that
  /// starts with it, and the rest of its line, are skipped; 0: there are no comments.
  TextReader(std::string_view text, std::size_t begin, std::stop_token stop, char comment = '\0')
      : text_(text), next_(begin), word_(begin), comment_(comment), pace_(std::move(stop)) {}

  /// Empty at the end of the text.
  std::string_view next();

  /// Continues after the end of the latest word's line. Whether that had more words.
  bool skip_line();

  /// The same, with what is left of the line, without a comment.
  std::string_view rest_of_line();

  /// Throws Error{malformed_mesh} if the next word is no number. It may be infinite or undefined.
  double number();

  /// Throws Error{malformed_mesh} unless the next word is a whole number in [least, most].
  std::int64_t whole(std::int64_t least, std::int64_t most);

  [[nodiscard]] std::size_t bytes_left() const { return text_.size() - next_; }
  [[nodiscard]] std::string place() const { return line_of_byte(text_, word_); }
  [[noreturn]] void refuse(const std::string& message) const;

 private:
  void skip_spaces();

  std::string_view text_;
  std::size_t next_;  ///< the first byte that is not read
  std::size_t word_;  ///< the first byte of the latest word
  char comment_;
  Pace pace_;
};

}  // namespace unwrapd::asset::mesh_files
