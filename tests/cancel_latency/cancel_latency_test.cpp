// How often work looks whether it shall stop, in looks for so many triangles; and that whoever is
// told so at any look says just that. (Times between looks: `./dev bench cancel-latency`.)
#include <gtest/gtest.h>

#include <limits>

#include "core/base/error.hpp"
#include "core/segment/base/test_parameterization.hpp"
#include "core/solve/base/metric.hpp"
#include "core/solve/maps/conformal.hpp"
#include "core/solve/maps/fill_holes.hpp"
#include "core/solve/repair/barrier.hpp"
#include "core/solve/repair/newton.hpp"
#include "core/solve/repair/patch.hpp"
#include "core/unwrap.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd {
namespace {

constexpr long kNever = std::numeric_limits<long>::max();

long looks = 0, last_look = kNever;

/// Of tokens that somebody could stop.
bool look(const std::stop_token& stop) { return stop.stop_possible() && ++looks > last_look; }

}  // namespace

extern "C" {
// NOLINTBEGIN(readability-identifier-naming, bugprone-reserved-identifier)
bool __wrap__ZN7unwrapd12is_cancelledERKSt10stop_token(const std::stop_token& stop) {
  return look(stop);
}
void __wrap__ZN7unwrapd18throw_if_cancelledERKSt10stop_token(const std::stop_token& stop) {
  if (look(stop)) throw Error(ErrorCode::cancelled, "told to stop");
}
// NOLINTEND(readability-identifier-naming, bugprone-reserved-identifier)
}

namespace {

template <class Work>
long looks_of(Work work, long last = kNever) {
  looks = 0, last_look = last;
  work();
  return looks;
}

struct Sample {
  shapes::OwnedDisk owned;
  std::stop_source source = {};
  UvMap flat = shapes::from_above(owned.disk.positions);
  long faces = static_cast<long>(owned.disk.faces.size());

  explicit Sample(TriMesh mesh = shapes::annulus(200, 50))
      : owned(shapes::disk_of(std::move(mesh))) {
    owned.disk.stop = source.get_token();
  }

  [[nodiscard]] const solve::Disk& disk() const { return owned.disk; }

  /// The least number of looks for so many triangles, gone over so many times.
  [[nodiscard]] long at_least(long times = 1) const { return times * (faces / 4096); }
};

TEST(CancelLatency, ComeWithEveryHoleFilled) {
  const Sample s;
  solve::Disk filled_disk;
  EXPECT_GE(looks_of([&] { filled_disk = solve::maps::fill_holes(s.disk()).disk; }), s.at_least());
  EXPECT_TRUE(filled_disk.stop.stop_possible());  // what is made of it looks as well
}

TEST(CancelLatency, ComeWithPatches) {
  const Sample s;
  std::vector<solve::repair::Patch> patches;
  const auto cut = [&] {
    patches = solve::repair::patches_around(s.disk(), std::vector<Index>{0}, 999, {});
  };
  EXPECT_GE(looks_of(cut), s.at_least());
  ASSERT_EQ(patches.size(), 1);
  EXPECT_EQ(long(patches[0].face.size()), s.faces);
  EXPECT_TRUE(patches[0].mesh.stop.stop_possible());
}

TEST(CancelLatency, ComeWithStepsUnderABarrier) {
  const Sample s;
  solve::repair::Patch whole =
      std::move(solve::repair::patches_around(s.disk(), std::vector<Index>{0}, 999, {})[0]);
  UvMap uv;
  for (Index v : whole.vertex) uv.push_back(s.flat[std::size_t(v)]);
  const solve::repair::Barrier barrier{{}, 1, 1};
  EXPECT_GE(looks_of([&] { solve::repair::barrier_energy(whole.mesh, uv, barrier); }),
            s.at_least());
  EXPECT_GE(looks_of([&] { solve::repair::least_determinant(whole.mesh, uv); }), s.at_least());
  solve::repair::Quadratic model;
  EXPECT_GE(looks_of([&] { model = solve::repair::barrier_pattern(whole.mesh); }), s.at_least(3));
  EXPECT_GE(looks_of([&] { solve::repair::fill_barrier_model(whole.mesh, uv, barrier, model); }),
            s.at_least());
  solve::repair::Newton newton(whole.mesh);
  const long by_hand =
      looks_of([&] { solve::repair::fill_barrier_model(whole.mesh, uv, barrier, model); }) +
      2 * looks_of([&] { solve::repair::barrier_energy(whole.mesh, uv, barrier); });
  newton.step(uv, barrier);  // the order of elimination is known from here on
  const long step = looks_of([&] { newton.step(uv, barrier); });
  EXPECT_GE(step, by_hand + 8);  // factor and solution
}

TEST(CancelLatency, ComeWithEverySolution) {
  const Sample s;
  const solve::InnerSystem inner(s.disk(), solve::cotan_laplacian(s.disk(), s.disk().rest));
  UvMap uv = s.flat;
  EXPECT_GE(looks_of([&] { inner.solve(uv); }), 4);
}

/// A spectral map takes a pinned one, one more factor, and a solution an iteration: more than one.
TEST(CancelLatency, ComeWithEveryIterationOfASpectralMap) {
  const Sample s(shapes::sphere_cap(120, 50, 2.8));
  const long pinned = looks_of([&] { solve::maps::conformal_map(s.disk(), Pins::diameter); });
  EXPECT_GT(looks_of([&] { solve::maps::conformal_map(s.disk(), Pins::spectral); }), 2 * pinned);
}

/// Whoever catches an error to try something else must let this one pass.
void expect_to_stop_at_any_look(const TriMesh& mesh, const UnwrapOptions& options, long tries) {
  const std::vector surfaces{shapes::surface_of(mesh)};
  const std::stop_source source;
  const Progress progress{{}, {}, source.get_token()};
  SerialExecutor serial;
  const auto work = [&] { unwrap(surfaces, options, progress, serial); };
  const long all = looks_of(work);
  for (long last = 0; last < all; last += 1 + all / tries) try {
      looks_of(work, last);
      ADD_FAILURE() << "went on after look " << last << " of " << all;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled) << e.what() << ", look " << last << " of " << all;
    }
}

/// A try is as long as a union is large: its order, factor, solutions and overlap test look, too.
TEST(CancelLatency, ComeWithEveryTryOfAUnion) {
  const TriMesh mesh = shapes::annulus(160, 50);
  const segment::SegmentationMesh surface =
      segment::make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
  segment::Region region;
  for (Index t = 0; t < surface.face_count(); ++t) region.faces.push_back(t);
  region.uv = segment::projected(surface, region.faces);
  const std::stop_source source;
  const segment::TestRules rules{.most_excess = 1, .stop = source.get_token()};
  const auto work = [&] {
    segment::Region own = region;
    return segment::test_parameterization(surface, {}, rules, own).verdict;
  };
  const long all = looks_of([&] { EXPECT_EQ(work(), segment::Verdict::sound); });
  EXPECT_GE(all, 40);
  for (long last = 3; last < all; last += all / 5)
    EXPECT_LE(looks_of(work, last), last + 40);  // it goes on nowhere
}

TEST(CancelLatency, AreObeyedByEveryMethod) {
  for (const Method method : {Method::asap, Method::arap, Method::hybrid, Method::abf,
                              Method::linabf, Method::cp, Method::bff, Method::ic, Method::slim}) {
    SCOPED_TRACE(static_cast<int>(method));
    expect_to_stop_at_any_look(
        shapes::annulus(24, 6),
        {.method = method, .pins = Pins::spectral, .guarantee = Guarantee::bijective}, 50);
  }
}

TEST(CancelLatency, AreObeyedWhereAMapIsMended) {
  for (const RepairMethod repair : {RepairMethod::untangle, RepairMethod::virtual_boundary})
    expect_to_stop_at_any_look(shapes::sphere_cap(12, 8, 3),
                               {.method = Method::asap,
                                .initial = InitialMap::lscm,
                                .guarantee = Guarantee::bijective,
                                .repair = repair},
                               10);
}

TEST(CancelLatency, AreObeyedWhereASurfaceIsTakenApart) {
  expect_to_stop_at_any_look(shapes::torus(10, 6), {}, 15);
}

}  // namespace
}  // namespace unwrapd
