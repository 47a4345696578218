// The size of a document's tree, told before it is made: a text of tiny values takes many times its
// bytes.
#include <algorithm>

#include "core/base/cancel.hpp"
#include "core/json/json.hpp"

namespace unwrapd::json {
namespace {

/// What is counted in a text to tell the size of its tree.
struct Marks {
  std::size_t commas = 0, containers = 0, members = 0, strings = 0;
  std::size_t long_text = 0;  ///< bytes of strings that lie outside their object
};

Marks count_marks(std::string_view text, const std::stop_token& stop) {
  Marks marks;
  for (std::size_t i = 0; i < text.size(); ++i) {
    check_cancelled_every(i, stop);
    switch (text[i]) {
      case ',':
        ++marks.commas;
        break;
      case ':':
        ++marks.members;
        break;
      case '[':
      case '{':
        ++marks.containers;
        break;
      case '"': {
        const std::size_t begin = i + 1;
        for (++i; i < text.size() && text[i] != '"'; ++i) {
          check_cancelled_every(i, stop);
          if (text[i] == '\\') ++i;
        }
        ++marks.strings;
        const std::size_t size = std::min(i, text.size()) - begin;
        if (size > 15) marks.long_text += size + 32;
        break;
      }
      default:
        break;
    }
  }
  return marks;
}

}  // namespace

std::size_t tree_bytes(std::string_view text, const std::stop_token& stop) {
  // Of glibc's malloc on 64 bits: a string that is a value has 48 bytes of its own, the vector of a
  // container 32 and what it holds 16 at least.
  const Marks marks = count_marks(text, stop);
  const std::size_t values = marks.commas + marks.containers + 1;
  return sizeof(Json) * values + sizeof(std::string) * marks.members + 48 * marks.containers +
         48 * (marks.strings - std::min(marks.strings, marks.members)) + marks.long_text;
}

}  // namespace unwrapd::json
