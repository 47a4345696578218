#include "core/base/lower_case.hpp"

#include <gtest/gtest.h>

namespace unwrapd {
namespace {

TEST(LowerCase, ChangesTheLettersOfAsciiAlone) {
  EXPECT_EQ(lower_case("Model/GLTF-Binary; Q=0.5"), "model/gltf-binary; q=0.5");
  EXPECT_EQ(lower_case("@[`{ \t\x7f"), "@[`{ \t\x7f");    // the neighbours of the letters
  EXPECT_EQ(lower_case("\xc3\x84\xc4"), "\xc3\x84\xc4");  // UTF-8, and a letter of Latin-1
  EXPECT_EQ(lower_case(""), "");
}

TEST(LowerCase, ChangesEachOfItsLetters) {
  for (int c = 0; c < 256; ++c) {
    const bool is_capital = c >= 0x41 && c <= 0x5a;
    ASSERT_EQ(lower_letter(static_cast<char>(c)), static_cast<char>(is_capital ? c + 0x20 : c));
  }
}

}  // namespace
}  // namespace unwrapd
