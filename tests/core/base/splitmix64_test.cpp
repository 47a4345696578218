#include "core/base/splitmix64.hpp"

#include <gtest/gtest.h>

namespace unwrapd {
namespace {

TEST(SplitMixSequence, GivesTheNumbersOfItsAuthors) {  // of their program from the seed 0
  SplitMixSequence sequence;
  EXPECT_EQ(sequence.next(), 0xe220a8397b1dcdafULL);
  EXPECT_EQ(sequence.next(), 0x6e789e6aa1b965f4ULL);
  EXPECT_EQ(sequence.below(1000), 0x06c45d188009454fULL % 1000);
}

}  // namespace
}  // namespace unwrapd
