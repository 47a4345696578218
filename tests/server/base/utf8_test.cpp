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
