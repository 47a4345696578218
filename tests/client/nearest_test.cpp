#include "client/nearest.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace unwrapd::client {
namespace {

std::string found(std::string_view given, const std::vector<std::string>& words) {
  const std::string* word = nearest(given, words);
  return word == nullptr ? "" : *word;
}

TEST(Nearest, IsTheWordOfTheFewestEditsUpToTwo) {
  const std::vector<std::string> words{"--method", "--max-charts", "--lambda", "--preset"};
  EXPECT_EQ(found("--metod", words), "--method");
  EXPECT_EQ(found("--methods", words), "--method");
  EXPECT_EQ(found("--lamdba", words), "--lambda");
  EXPECT_EQ(found("--preset", words), "--preset");
  EXPECT_EQ(found("--mthds", words), "");
  EXPECT_EQ(found("", words), "");
  EXPECT_EQ(found("ab", {"cd"}), "");  // nothing of it is left
  EXPECT_EQ(found("abcd", {"abce", "abcf"}), "abce");
}

}  // namespace
}  // namespace unwrapd::client
