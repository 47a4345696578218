#include "api/json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "core/base/error.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

Error refusal(const std::string& text, const JsonLimits& limits = {}) {
  return error_of([&] { parse_json(text, limits); });
}

std::string nested(int depth) {
  return std::string(static_cast<std::size_t>(depth), '[') +
         std::string(static_cast<std::size_t>(depth), ']');
}

TEST(ParseJson, KeepsTheOrderOfMembers) {
  EXPECT_EQ(parse_json(R"({"b":1,"a":[true,null,"x"]})").dump(), R"({"b":1,"a":[true,null,"x"]})");
}

TEST(ParseJson, RefusesEveryPrefixOfAGoodText) {
  const std::string text = R"({"method":"arap","lambda":0.5,"nested":{"a":[1,2]}})";
  for (std::size_t n = 0; n < text.size(); ++n) {
    EXPECT_EQ(refusal(text.substr(0, n)).code(), ErrorCode::malformed_request) << n;
  }
  EXPECT_EQ(refusal(text + "x").code(), ErrorCode::malformed_request);
}

TEST(ParseJson, RefusesADuplicateMemberAndPointsAtIt) {
  const Error top = refusal(R"({"a":1,"b":2,"a":1})");
  EXPECT_EQ(top.code(), ErrorCode::invalid_option);
  EXPECT_EQ(top.where(), "/a");
  EXPECT_EQ(refusal(R"({"a":{"x/y":1,"x/y":2}})").where(), "/a/x~1y");
}

TEST(ParseJson, TakesTheSameNameInDifferentObjects) {
  EXPECT_NO_THROW(parse_json(R"({"a":{"a":1},"b":{"a":1},"c":[{"a":1},{"a":2}]})"));
}

TEST(ParseJson, RefusesANumberThatNoDoubleHolds) {
  const Error error = refusal(R"({"lambda":1e999})");
  EXPECT_EQ(error.code(), ErrorCode::invalid_option);
  EXPECT_EQ(error.where(), "/lambda");
}

TEST(ParseJson, RefusesNaNAndInfinityAsTheyAreNoJson) {
  for (const char* text : {"NaN", "Infinity", "-Infinity", "nan", "{\"lambda\":NaN}"}) {
    EXPECT_EQ(refusal(text).code(), ErrorCode::malformed_request) << text;
  }
}

TEST(ParseJson, KeepsItsLimitsOfDepthAndSize) {
  EXPECT_NO_THROW(parse_json(nested(4), {.max_bytes = 64, .max_depth = 4}));
  EXPECT_EQ(refusal(nested(5), {.max_bytes = 64, .max_depth = 4}).code(),
            ErrorCode::malformed_request);
  EXPECT_EQ(refusal(nested(1'000'000), {.max_bytes = 4'000'000, .max_depth = 16}).code(),
            ErrorCode::malformed_request);
  EXPECT_NO_THROW(parse_json("[1]", {.max_bytes = 3, .max_depth = 4}));
  EXPECT_NO_THROW(parse_json(R"([1, {"a": []}])", {.max_values = 5}));
  EXPECT_EQ(refusal(R"([1, {"a": []}])", {.max_values = 4}).code(), ErrorCode::malformed_request);
  EXPECT_NO_THROW(parse_json(R"({"a":1,"b":{"c":1,"d":2}})", {.max_members = 2}));
  EXPECT_EQ(refusal(R"([{"a":1,"b":2,"c":3}])", {.max_members = 2}).where(), "/0/b");
  EXPECT_EQ(refusal("[1] ", {.max_bytes = 3, .max_depth = 4}).code(), ErrorCode::malformed_request);
}

TEST(ParseJson, RefusesTextThatIsNotUtf8) {
  EXPECT_EQ(refusal("\"\xff\"").code(), ErrorCode::malformed_request);
  EXPECT_EQ(refusal("\"\xc3\"").code(), ErrorCode::malformed_request);
}

TEST(ParseJson, ThrowsNothingButErrorOnRandomBytes) {
  std::mt19937 rng(7);
  const std::string alphabet = "{}[]\",:0123456789.eE+-truefalsn \\u\x01\xff";
  std::uniform_int_distribution<std::size_t> length(0, 40);
  std::uniform_int_distribution<std::size_t> letter(0, alphabet.size() - 1);
  for (int k = 0; k < 20'000; ++k) {
    std::string text(length(rng), ' ');
    for (char& c : text) c = alphabet[letter(rng)];
    try {
      parse_json(text);
    } catch (const Error&) {  // any other exception ends the test
    }
  }
}

TEST(Finite, LeavesFiguresAloneAndBoundsTheRest) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(finite(-2.5), -2.5);
  EXPECT_EQ(finite(infinity), std::numeric_limits<double>::max());
  EXPECT_EQ(finite(-infinity), -std::numeric_limits<double>::max());
  EXPECT_TRUE(std::isfinite(finite(std::nan(""))));
}

}  // namespace
}  // namespace unwrapd::api
