#include "server/work/uv_file.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace unwrapd::server::work {
namespace {

std::vector<UnwrappedSurface> two_surfaces() {
  const UnwrappedSurface square{.faces = {{0, 1, 2}, {0, 2, 3}},
                                .source = {0, 1, 2, 3},
                                .uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0.1}}};
  return {square, {}};
}

TEST(UvFile, GivesBackWhatItWasGiven) {
  const std::vector<UnwrappedSurface> before = two_surfaces();
  const std::vector<UnwrappedSurface> after = decode_uvs(encode_uvs(before));
  ASSERT_EQ(after.size(), 2U);
  EXPECT_EQ(after[0].faces, before[0].faces);
  EXPECT_EQ(after[0].source, before[0].source);
  EXPECT_EQ(after[0].uv, before[0].uv);
  EXPECT_TRUE(after[1].faces.empty());
}

TEST(UvFile, RefusesEveryPrefixAndEveryLongerFile) {
  const std::string whole = encode_uvs(two_surfaces());
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(decode_uvs(whole.substr(0, size)), Error) << size;
  EXPECT_THROW(decode_uvs(whole + "x"), Error);
}

TEST(UvFile, RefusesCountsThatTheFileCannotHold) {
  std::string bytes = encode_uvs(two_surfaces());
  for (std::size_t at = 13; at < 21; ++at) bytes[at] = '\x7f';
  EXPECT_THROW(decode_uvs(bytes), Error);
}

}  // namespace
}  // namespace unwrapd::server::work
