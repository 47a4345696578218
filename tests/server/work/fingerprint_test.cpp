// Keys of kept things: other arguments, another key.
#include "core/types/cache_key.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/mesh/halfedges.hpp"
#include "core/solve/base/disk.hpp"
#include "tests/server/shared_jobs.hpp"

namespace unwrapd::server::work {
namespace {

TEST(CacheKey, TellsWhereOneArgumentEndsAndTheNextBegins) {
  const SolverCache core({}, 1);
  const std::string ab = "ab", a = "a", bc = "bc", c = "c", none;
  const std::vector<std::string> two{a, bc}, one{"abc"}, more{a, bc, none};
  const std::optional<int> nothing, zero = 0;
  const std::string longer(100, 'x');
  std::vector<Digest> all;
  const auto add = [&](const auto&... values) {
    CacheKey key(core);
    (key.add(values), ...);
    all.push_back(key.digest());
  };
  add(ab, c), add(a, bc), add(two), add(one), add(more), add(ab, c, none);
  add(nothing), add(zero), add(nothing, nothing), add(longer), add(longer + "y"), add(longer, a);
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
}

/// A list that takes the place of one that knew its digest is told from it, though the disk that it
/// is in was copied.
TEST(CacheKey, OfADiskIsOfWhatTheDiskHoldsNow) {
  SolverCache core(MemoryLimits{}, 1);
  ThreadExecutor executor(1, &core);
  const TriMesh mesh = shapes::random_disk(5, 3);
  const Halfedges halfedges = build_halfedges(mesh.faces, mesh.vertex_count());
  const std::vector<BoundaryLoop> loops = boundary_loops(mesh, halfedges);
  const solve::Disk disk = solve::make_disk(mesh, loops, executor);
  const auto key = [&](const solve::Disk& d) { return CacheKey(core).add(d).digest(); };
  const Digest own = key(disk);
  EXPECT_EQ(key(solve::make_disk(mesh, loops, executor)), own);
  std::vector<solve::Disk> others(7, disk);
  std::vector<measure::RestTriangle> rest(disk.rest.begin(), disk.rest.end());
  rest.back().area *= 2;
  others[0].rest = std::move(rest);
  std::vector<Vec3> positions(disk.positions.begin(), disk.positions.end());
  positions.front().x() += 1;
  others[1].positions = std::move(positions);
  std::vector<Triangle> faces(mesh.faces);
  std::swap(faces[3], faces[7]);
  others[2].faces = faces;
  others[3].loops = std::span(loops).first(0);
  others[4].twin = halfedges.twin;
  others[5].unit *= 2;
  others[6].is_ordered = true;
  std::vector<Digest> all{own};
  for (const solve::Disk& other : others) all.push_back(key(other));
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
}

}  // namespace
}  // namespace unwrapd::server::work
