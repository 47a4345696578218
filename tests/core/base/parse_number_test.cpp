#include "core/base/parse_number.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace unwrapd {
namespace {

TEST(ParseNumber, TakesTextThatIsANumberAsAWhole) {
  EXPECT_EQ(parse_number<int>("-12"), -12);
  EXPECT_EQ(parse_number<std::int64_t>("9223372036854775807"), INT64_MAX);
  EXPECT_EQ(parse_number<double>("-2.5e3"), -2500);
  for (const char* text : {"", "+1", " 1", "1 ", "1x", "1.5", "0x10", "-"})
    EXPECT_EQ(parse_number<int>(text), std::nullopt) << text;
}

TEST(ParseNumber, RefusesWhatDoesNotFit) {
  EXPECT_EQ(parse_number<int>("2147483648"), std::nullopt);
  EXPECT_EQ(parse_number<std::int64_t>("9223372036854775808"), std::nullopt);
  EXPECT_EQ(parse_number<double>("1e999"), std::nullopt);
  EXPECT_EQ(parse_number<unsigned>("-1"), std::nullopt);
}

}  // namespace
}  // namespace unwrapd
