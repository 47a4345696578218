#include "core/json/json.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <string>

namespace unwrapd::json {
namespace {

/// Thrown by policies of these tests, so that every part of a refusal can be looked at.
struct Refused {
  Refusal refusal;
};

Error rethrow(const Refusal& refusal) { throw Refused{refusal}; }

std::optional<Refusal> refusal_of(const std::string& text, Policy policy = {.error = rethrow}) {
  try {
    read(text, policy);
  } catch (const Refused& refused) {
    return refused.refusal;
  }
  return std::nullopt;
}

void expect_refusal(const std::string& text, Fault fault, const std::string& pointer,
                    Policy policy = {.error = rethrow}) {
  const std::optional<Refusal> refusal = refusal_of(text, policy);
  ASSERT_TRUE(refusal) << text;
  EXPECT_EQ(refusal->fault, fault) << text;
  EXPECT_EQ(refusal->pointer, pointer) << text;
}

TEST(JsonRead, TellsThePlaceOfEveryFault) {
  expect_refusal(R"({"a":[1,{"b":1,"b":2}]})", Fault::repeated_name, "/a/1/b");
  expect_refusal(R"({"a":{"~/":1,"~/":2}})", Fault::repeated_name, "/a/~0~1");
  expect_refusal(R"([[],{},[0,1e999]])", Fault::number_range, "/2/1");
  expect_refusal(R"({"a":1,"b":{"c":-1e400}})", Fault::number_range, "/b/c");
  expect_refusal(R"({"a":[1,2)", Fault::syntax, "/a/2");
  expect_refusal(R"([0,[[]]])", Fault::too_deep, "/1/0", {.error = rethrow, .max_depth = 2});
  expect_refusal(R"([{"a":1,"b":2,"c":3}])", Fault::too_many_members, "/0/b",
                 {.error = rethrow, .max_members = 2});
}

TEST(JsonRead, KeepsEachLimitExactly) {
  const std::string text = R"({"a":[1,2],"b":{}})";  // 5 values and 2 names, on 2 levels
  EXPECT_FALSE(refusal_of(text, {.error = rethrow,
                                 .max_bytes = text.size(),
                                 .max_tree_bytes = tree_bytes(text, {}),
                                 .max_depth = 2,
                                 .max_values = 7,
                                 .max_members = 2}));
  EXPECT_EQ(refusal_of(text, {.error = rethrow, .max_bytes = text.size() - 1})->fault,
            Fault::too_long);
  EXPECT_EQ(refusal_of(text, {.error = rethrow, .max_tree_bytes = tree_bytes(text, {}) - 1})->fault,
            Fault::too_dense);
  EXPECT_EQ(refusal_of(text, {.error = rethrow, .max_depth = 1})->fault, Fault::too_deep);
  EXPECT_EQ(refusal_of(text, {.error = rethrow, .max_values = 6})->fault, Fault::too_many_values);
  EXPECT_EQ(refusal_of(text, {.error = rethrow, .max_members = 1})->fault, Fault::too_many_members);
}

/// An object of so many names, of which the last is that at `last` once more.
std::string repeating(int names, int last) {
  std::string text = "{";
  for (int i = 0; i < names; ++i) text += "\"name " + std::to_string(i) + "\":{\"name 0\":[]},";
  return text + "\"name " + std::to_string(last) + "\":0}";
}

TEST(JsonRead, FindsANameThatIsRepeatedInObjectsOfAnySize) {
  for (const int names : {1, 2, 15, 16, 17, 18, 40, 3000})
    for (const int last : {0, names / 2, names - 1})
      expect_refusal(repeating(names, last), Fault::repeated_name, "/name " + std::to_string(last));
  for (const int names : {1, 15, 16, 17, 3000}) EXPECT_FALSE(refusal_of(repeating(names, names)));
}

/// Text made of words of JSON, so that many of the texts are JSON.
std::string random_text(std::mt19937& rng) {
  constexpr const char* kWords[] = {
      "{",     "}",           "[", "]",    ",",   ":",    "\"a\"",
      "\"b\"", "\"\\u00e9\"", "1", "-0",   "1e5", "0.25", "18446744073709551616",
      "true",  "null",        " ", "\xff", "01"};
  std::uniform_int_distribution<std::size_t> word(0, std::size(kWords) - 1);
  std::uniform_int_distribution<int> length(1, 9);
  std::string text;
  for (int n = length(rng); n > 0; --n) text += kWords[word(rng)];
  return text;
}

TEST(JsonRead, AgreesWithTheLibrarysOwnParser) {
  std::mt19937 rng(11);
  int good = 0;
  for (int k = 0; k < 30'000; ++k) {
    const std::string text = random_text(rng);
    const std::optional<Refusal> refusal = refusal_of(text);
    if (refusal && refusal->fault == Fault::repeated_name) continue;
    ASSERT_EQ(!refusal, Json::accept(text)) << text;
    if (refusal) continue;
    ++good;
    ASSERT_EQ(read(text, {.error = rethrow}).dump(), Json::parse(text).dump()) << text;
  }
  EXPECT_GT(good, 300);
}

}  // namespace
}  // namespace unwrapd::json
