#include <gtest/gtest.h>

#include <cstdlib>

TEST(Ends, Well) {}

TEST(Ends, WellToo) { EXPECT_EQ(std::getenv("WORD"), std::string("of the environment")); }

TEST(Ends, InFailure) { FAIL() << "as it should"; }

TEST(Ends, Skipped) { GTEST_SKIP(); }

TEST(Ends, InACrash) { std::abort(); }

TEST(Ends, BehindACrash) {}

/// As a leak that the sanitizer tells: all cases passed.
TEST(Ends, InAStatus) {
  std::atexit([] { std::_Exit(23); });
}
