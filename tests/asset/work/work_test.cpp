// What every stage of reading and writing does is counted, not timed.
#include <gtest/gtest.h>

#include <cstdint>

#include "tests/asset/support.hpp"
#include "tests/asset/work/block_count.hpp"
#include "tests/asset/work/families.hpp"

namespace unwrapd::asset::test {
namespace {

constexpr double kMostGrowth = 1.3;  // of the work on a byte when a file is four times as large
constexpr double kMostWork = 3000;   // blocks on a byte; a star of 512 corners takes the most

/// [stage]: blocks on a byte of the file.
using Work = std::map<std::string, double>;

Work work_of(const MadeFile& file) {
  Work work;
  const auto count = [&](const char* stage, const auto& run) {
    const std::uint64_t before = block_count();
    auto result = run();
    work[stage] =
        static_cast<double>(block_count() - before) / static_cast<double>(file.bytes.size());
    return result;
  };
  Asset asset = count("read", [&] { return read({file.bytes, {}}, {}, file.options); });
  count("read_uvs", [&] { return read_uvs(asset), 0; });
  const std::vector<UnwrappedSurface> unwrapped = split_nowhere(asset);
  for (const auto& [stage, format] :
       {std::pair("write glb", Format::glb), std::pair("write gltf", Format::gltf),
        std::pair("write obj", Format::obj)})
    count(stage, [&] { return write(asset, unwrapped, format); });
  count("vertex_maps", [&] { return vertex_maps(asset, unwrapped, Format::glb); });
  count("side_effects", [&] { return side_effects(asset, unwrapped, Format::glb); });
  return work;
}

void expect_linear(const std::vector<Family>& families) {
  for (const Family& family : families) {
    const Work small = work_of(family.make(family.size));
    const Work large = work_of(family.make(4 * family.size));
    for (const auto& [stage, work] : large) {
      EXPECT_LE(work, kMostGrowth * small.at(stage) + 1) << family.name << ": " << stage;
      EXPECT_LE(work, kMostWork) << family.name << ": " << stage;
    }
  }
}

TEST(Work, OnAGltfGrowsAsItsBytes) { expect_linear(gltf_families()); }

TEST(Work, OnAnObjGrowsAsItsBytes) { expect_linear(obj_families()); }

TEST(Work, IsCounted) {
  const std::uint64_t before = block_count();
  read_file(square().glb());
  EXPECT_GT(block_count(), before + 1000);
}

}  // namespace
}  // namespace unwrapd::asset::test
