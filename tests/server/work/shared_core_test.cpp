// What jobs share must not be seen in what they answer: every job gives the bytes that it would
// give alone, whatever ran before it. In each list below two neighbours differ in one thing that
// counts, so that a key which leaves it out gives one of them the answer of the other.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>

#include "tests/core/hard_shapes.hpp"
#include "tests/core/rounded.hpp"
#include "tests/server/shared_jobs.hpp"

namespace unwrapd::server::work {
namespace {

void expect_answers_as_alone(const std::vector<Surfaces>& meshes,
                             const std::vector<UnwrapOptions>& jobs) {
  SolverCache cache(kRoomForAll, 1);
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      const std::string alone = answer(meshes[m], jobs[k], nullptr);
      for (int again : {0, 1})
        EXPECT_TRUE(answer(meshes[m], jobs[k], &cache, 2) == alone)
            << "mesh " << m << ", job " << k << ", again " << again;
    }
  EXPECT_GT(cache.counters().hits, 0U);
}

/// UVs that came in, with a seam that moves with `column`.
Surface with_uvs(const TriMesh& mesh, double column) {
  Surface surface = shapes::surface_of(mesh);
  for (const Triangle& face : mesh.faces) {
    double mean = 0;
    for (const Index v : face) mean += mesh.positions[static_cast<std::size_t>(v)].x() / 3;
    CornerUv& uv = surface.corner_uv.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = mesh.positions[static_cast<std::size_t>(face[i])];
      uv[i] = Vec2(p.x() + (mean > column ? 5 : 0), p.y());
    }
  }
  return surface;
}

/// A disk with one more face at an edge, up to a vertex at `tip`: its number is 36.
TriMesh with_flap(TriMesh disk, const Vec3& tip) {
  disk.positions.push_back(tip);
  disk.faces.push_back({1, 0, 36});
  return disk;
}

/// A sheet that is rolled up until two of its sides are a little apart, or meet.
TriMesh rolled_up(bool meet) {
  return shapes::mapped_grid(8, 3, shapes::Wrap::none, [&](double u, double v) {
    const double angle = shapes::kTurn * (meet && u == 1 ? 0 : 0.99 * u);
    return Vec3(std::cos(angle), std::sin(angle), v);
  });
}

/// The same disk, and what differs from it in places, order, parts, copies, size or UVs alone.
std::vector<Surfaces> related_disks() {
  const TriMesh disk = shapes::random_disk(5, 3);
  TriMesh larger = disk, touching = disk, swapped = disk;
  for (Vec3& p : larger.positions) p *= 2;  // the same in units of its own size
  touching.positions[1] = touching.positions[0];
  std::swap(swapped.faces[3], swapped.faces[20]);
  const Vec3 &start = disk.positions[0], &end = disk.positions[1];
  const TriMesh flat = with_flap(disk, (start + end) / 2), shut = with_flap(disk, start),
                raised = with_flap(disk, start - Vec3(0, 0.2, 0.1));
  Surface in_two = shapes::surface_of(disk);
  for (std::size_t t = 0; t < in_two.part.size(); t += 2) in_two.part[t] = 1;
  std::vector<Surfaces> all{{with_uvs(disk, 0.3)}, {with_uvs(disk, 0.6)}, {in_two}};
  for (const TriMesh& mesh : {disk, swapped, larger, bent(disk, 0.2), shapes::soup(disk), touching,
                              flat, shut, raised, rolled_up(false), rolled_up(true)})
    all.push_back({shapes::surface_of(mesh)});
  return all;
}

TEST(JobsThatShare, AnswerAsTheyWouldAloneHoweverTheySolve) {
  std::vector<UnwrapOptions> jobs(6);  // until they converge
  jobs[1].stop.tolerance = 1e-2;
  jobs[2].stop.max_iterations = 2;
  jobs[3].guarantee = Guarantee::bijective, jobs[3].padding = 7;
  jobs[4].method = Method::asap;
  jobs[5].method = Method::asap, jobs[5].pins = Pins::spectral;
  UnwrapOptions two;
  two.stop.iterations = 2;
  for (InitialMap initial : {InitialMap::automatic, InitialMap::lscm, InitialMap::tutte})
    jobs.push_back(two), jobs.back().initial = initial;
  two.method = Method::hybrid, two.lambda = 1;
  jobs.push_back(two);
  jobs.push_back(two), jobs.back().lambda = 2;
  jobs.push_back(two), jobs.back().lambda_units = LambdaUnits::paper;
  jobs.push_back(two), jobs.back().stop.iterations = 3;
  jobs.push_back(two), jobs.back().lambda_curve = {1, 3};
  jobs.push_back(two), jobs.back().boundary = BoundaryShape::circle;
  jobs.push_back(two), jobs.back().method = Method::slim;
  expect_answers_as_alone(related_disks(), jobs);
}

TEST(JobsThatShare, AnswerAsTheyWouldAloneHoweverTheyCut) {
  std::vector<UnwrapOptions> jobs(8);
  for (UnwrapOptions& options : jobs) options.stop.iterations = 2;
  jobs[6].max_distortion = jobs[7].max_distortion = 2.002;
  jobs[7].keep_edges = {{.surface = 0, .vertices = {14, 15, 16}}};
  jobs[1].seams = SeamMode::keep;
  jobs[2].seams = SeamMode::none;
  jobs[3].seams = SeamMode::uv0;
  jobs[4].seam_edges = {{.surface = 0, .vertices = {14, 15, 16}}};
  jobs[5].seam_edges = {{.surface = 0, .vertices = {20, 21, 22}}};
  std::vector<Surfaces> meshes = related_disks();
  std::erase_if(meshes, [](const Surfaces& mesh) {  // which has no such edges
    return mesh.front().mesh.positions.size() > 37;
  });
  ASSERT_GE(meshes.size(), 6U);
  expect_answers_as_alone(meshes, jobs);
}

TEST(JobsThatShare, AnswerAsTheyWouldAloneHoweverTheyWeld) {
  shapes::Rounded soup = shapes::rounded_soup(shapes::random_disk(3, 3), 1e-7, 5);
  shapes::wind_at_random(0.5, 6, soup);
  std::vector<UnwrapOptions> jobs(3);
  for (UnwrapOptions& options : jobs) options.stop.iterations = 2;
  jobs[1].welding.mode = WeldMode::exact;
  jobs[2].welding = {.mode = WeldMode::distance, .distance = 1e-9};
  expect_answers_as_alone({{shapes::surface_of(soup.mesh)}}, jobs);
}

TEST(JobsThatShare, AnswerAsTheyWouldAloneHoweverTheyArePacked) {
  std::vector<UnwrapOptions> jobs(8);
  for (UnwrapOptions& options : jobs) options.stop.iterations = 2;
  jobs[7].page_fit = PageFit::multiple_of_four;
  jobs[7].packing.texels_per_unit = 100;
  jobs[3].width = 2048;
  jobs[4].height = 2048;
  jobs[5].packing.group = PageGroup::mesh;
  jobs[6].straighten = Straighten::automatic;
  jobs[1].packing.rotation = Rotation::quarter;
  jobs[2].packing.rotation = Rotation::none;
  expect_answers_as_alone({{shapes::surface_of(shapes::sphere(0))}}, jobs);
}

TEST(JobsThatShare, AnswerAsTheyWouldAloneWhateverPartsFacesAreOf) {
  const Surface soup = shapes::surface_of(shapes::soup(shapes::random_disk(2, 3)));
  Surface in_two = soup;  // faces of two parts are joined where they meet
  for (std::size_t t = 0; t < in_two.part.size(); t += 2) in_two.part[t] = 1;
  UnwrapOptions options{.seams = SeamMode::keep};
  options.stop.iterations = 2;
  expect_answers_as_alone({{soup}, {in_two}}, {options});
}

TEST(JobsThatShare, AnswerAsTheyWouldAloneHoweverTheyTakeBodiesApart) {
  const Surface disk = shapes::surface_of(shapes::random_disk(4, 3));
  const Surface ball = shapes::surface_of(shapes::sphere(0));
  const Surface other = shapes::surface_of(bent(ball.mesh, 0.3));
  std::vector<UnwrapOptions> jobs(8);
  for (UnwrapOptions& options : jobs) options.stop.iterations = 2;
  jobs[6].effort = Effort::fast;
  jobs[7].symmetry = Symmetry::automatic;
  jobs[1].max_charts = 1;
  jobs[2].max_charts = 2;
  jobs[3].max_distortion = 2.2;
  jobs[4].max_distortion = 3;
  jobs[5].boundary = BoundaryShape::circle;  // one chart for each body
  expect_answers_as_alone({{ball}}, jobs);
  jobs.resize(2);
  expect_answers_as_alone({{ball}, {other}, {disk, ball}}, jobs);
}

/// The same positions: nothing painted, 0 everywhere, one half or the other, or one less.
TEST(JobsThatShare, AnswerAsTheyWouldAloneHoweverTheyArePainted) {
  const Surface bare = shapes::surface_of(shapes::sphere(1));
  std::vector<Surfaces> meshes{{bare}};
  for (const double x : {0.0, 1.0, -1.0, 0.5})
    for (std::vector<double> Surface::*field : {&Surface::seam_avoid, &Surface::texel_density}) {
      Surface painted = bare;
      for (const Vec3& p : bare.mesh.positions)
        (painted.*field).push_back(std::clamp(x * p.x(), 0.0, 1.0));
      meshes.push_back({painted});
    }
  std::vector<UnwrapOptions> jobs(2);
  for (UnwrapOptions& options : jobs) options.stop.iterations = 2;
  jobs[1].max_charts = 1;
  expect_answers_as_alone(meshes, jobs);
  std::ranges::reverse(meshes);
  expect_answers_as_alone(meshes, jobs);
  for (const std::size_t zero : {6, 7})
    EXPECT_TRUE(answer(meshes[zero], jobs[0], nullptr) == answer({bare}, jobs[0], nullptr));
  EXPECT_FALSE(answer(meshes[5], jobs[0], nullptr) == answer({bare}, jobs[0], nullptr));
}

TEST(JobsThatShare, AnswerAsTheyWouldAloneUnderConstraints) {
  std::vector<UnwrapOptions> jobs;
  for (Index last : {20, 21}) {
    UnwrapOptions options;
    options.constraints = {{.surface = 0, .vertex = 3, .uv = Vec2(0.2, 0.2)},
                           {.surface = 0, .vertex = last, .uv = Vec2(0.7, 0.6)}};
    jobs.push_back(options);
    jobs.push_back(options), jobs.back().constraints.pop_back();
    jobs.push_back(options), jobs.back().constraints.back().weight = 1;
  }
  jobs.emplace_back();
  expect_answers_as_alone({{shapes::surface_of(shapes::random_disk(6, 3))}}, jobs);
}

TEST(JobsThatShare, AnswerAsTheyWouldAloneOnHardShapes) {
  std::vector<Surfaces> hard;
  for (const auto& shape : shapes::hard_disks()) hard.push_back({shapes::surface_of(shape.mesh)});
  for (const auto& shape : shapes::broken_surfaces())
    hard.push_back({shapes::surface_of(shape.mesh)});
  UnwrapOptions options{.max_charts = 1};
  options.stop.iterations = 4;
  expect_answers_as_alone(hard, {options});
}

TEST(JobsThatShare, MakeNothingForAnotherLambdaButItsIterations) {
  const Surfaces mesh{shapes::surface_of(shapes::random_disk(12, 3))};
  SolverCache cache(kRoomForAll, 1);
  UnwrapOptions options;
  options.stop.iterations = 4;
  answer(mesh, options, &cache);
  options.method = Method::hybrid;
  for (double lambda : {0.1, 0.3, 0.5, 1.0, 10.0}) {
    const std::uint64_t before = cache.counters().misses;
    options.lambda = lambda;
    answer(mesh, options, &cache);
    EXPECT_EQ(cache.counters().misses, before + 1) << lambda;
  }
}

TEST(JobsThatShare, KeepToTheBytesThatMayBeKept) {
  for (std::int64_t most : {0, 20'000, 60'000}) {
    SolverCache cache({.cache_bytes = most, .job_bytes = kRoomForAll.job_bytes}, 1);
    for (const Surfaces& mesh : related_disks()) {
      UnwrapOptions options;
      options.stop.iterations = 2;
      EXPECT_TRUE(answer(mesh, options, &cache) == answer(mesh, options, nullptr)) << most;
      EXPECT_LE(cache.counters().bytes, static_cast<std::size_t>(most));
    }
    EXPECT_GT(cache.counters().evictions, 0U);
  }
}

std::size_t allocated() {
  const struct mallinfo2 now = ::mallinfo2();
  return now.uordblks + now.hblkhd;
}

TEST(JobsThatShare, CountTheBytesThatTheyKeep) {
  if (allocated() == 0) GTEST_SKIP() << "this allocator tells nothing";
  for (const TriMesh& mesh : {shapes::random_disk(60, 3), shapes::sphere(4)}) {
    const Surfaces surfaces{shapes::surface_of(mesh)};
    const UnwrapOptions options{.max_charts = 1};
    answer(surfaces, options, nullptr);  // what is made but once in a process
    const std::size_t before = allocated();
    SolverCache cache(kRoomForAll, 1);
    answer(surfaces, options, &cache);
    const double counted = static_cast<double>(cache.counters().bytes);
    const double share = counted / static_cast<double>(allocated() - before);
    EXPECT_GT(share, 1);  // what two entries have in common counts with both: either may go
    EXPECT_LT(share, 1.2);
  }
}

}  // namespace
}  // namespace unwrapd::server::work
