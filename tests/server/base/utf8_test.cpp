// Text is told from what is none as the parser of JSON tells it.
#include "server/base/utf8.hpp"

#include <gtest/gtest.h>

#include <string>

#include "api/json.hpp"

namespace unwrapd::server {
namespace {

bool json_takes(const std::string& text) {
  try {
    static_cast<void>(api::Json(text).dump());
    return true;
  } catch (const api::Json::exception&) {
    return false;
  }
}

TEST(Utf8, IsWhatJsonTakesForText) {
  for (unsigned first = 0; first < 256; ++first)
    for (const unsigned second :  // where something begins or ends
         {0x00U, 0x7FU, 0x80U, 0x8FU, 0x90U, 0x9FU, 0xA0U, 0xBFU, 0xC0U, 0xFFU}) {
      std::string text = {static_cast<char>(first), static_cast<char>(second)};
      for (const char* tail : {"", "\x80", "\xbf\x80", "x"})
        ASSERT_EQ(is_utf8_text(text + tail), json_takes(text + tail)) << first << ' ' << second;
    }
}

/// Of each code point alone, so that neither neighbour of a refused range is refused with it.
TEST(Utf8, IsAPlainLineWithoutControlsSeparatorsAndMarksOfDirection) {
  const auto is_hidden = [](unsigned code) {
    return code < 0x20U || (code >= 0x7FU && code < 0xA0U) ||
           (code >= 0x2028U && code <= 0x202EU) || (code >= 0x2066U && code <= 0x2069U);
  };
  for (unsigned code = 0; code < 0x3000U; ++code) {
    std::string text;
    if (code < 0x80U) {
      text = {static_cast<char>(code)};
    } else if (code < 0x800U) {
      text = {static_cast<char>(0xC0U | (code >> 6U)), static_cast<char>(0x80U | (code & 0x3FU))};
    } else {
      text = {static_cast<char>(0xE0U | (code >> 12U)),
              static_cast<char>(0x80U | ((code >> 6U) & 0x3FU)),
              static_cast<char>(0x80U | (code & 0x3FU))};
    }
    ASSERT_EQ(is_plain_line("a" + text + "b"), !is_hidden(code)) << code;
    ASSERT_EQ(count_characters("a" + text + "b"), 3U) << code;
  }
  EXPECT_FALSE(is_plain_line("\xff"));
  EXPECT_TRUE(is_plain_line("\U0001FA91 7"));
}

TEST(Utf8, IsCutBetweenCharacters) {
  const std::string text = "a\u00e4\u20ac\U0001F600";
  for (std::size_t most = 0; most <= text.size(); ++most) {
    const std::string_view cut = within_bytes(text, most);
    EXPECT_LE(cut.size(), most);
    EXPECT_GT(cut.size() + 4, most);
    EXPECT_TRUE(is_utf8_text(cut)) << most;
  }
  EXPECT_EQ(within_bytes(text, 100), text);
}

}  // namespace
}  // namespace unwrapd::server
