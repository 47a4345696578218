// Islands that stay while others are packed around them, through the front door. Gaps are measured
// here between the triangles themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::pipeline {
namespace {

/// A rectangle in the plane of UVs; two triangles, in space of its size and far from others.
struct Sheet {
  Vec2 low, size;
};

Surface sheets(const std::vector<Sheet>& all) {
  Surface surface{{}, {}, "sheets"};
  for (const auto& [low, size] : all) {
    const auto first = static_cast<Index>(surface.mesh.positions.size());
    const std::array<Vec2, 4> ends = {Vec2(0, 0), Vec2(size.x(), 0), size, Vec2(0, size.y())};
    for (const Vec2& p : ends) surface.mesh.positions.emplace_back(p.x(), p.y(), double(first));
    for (const Triangle& face : {Triangle{0, 1, 2}, {0, 2, 3}}) {
      surface.mesh.faces.push_back({first + face[0], first + face[1], first + face[2]});
      surface.corner_uv.push_back({low + ends[std::size_t(face[0])],
                                   low + ends[std::size_t(face[1])],
                                   low + ends[std::size_t(face[2])]});
    }
  }
  surface.part.assign(surface.mesh.faces.size(), 0);
  return surface;
}

struct Around {
  Surface surface;
  Unwrapped result;

  [[nodiscard]] Vec2 corner(std::size_t face, std::size_t i) const {
    const UnwrappedSurface& own = result.surfaces[0];
    return own.uv[std::size_t(own.faces[face][i])];
  }
};

UnwrapOptions locking(const std::vector<Index>& faces) {
  UnwrapOptions options{.resolution = 256, .padding = 4, .repack_only = true};
  for (const Index face : faces) options.locked_islands.push_back({0, face});
  return options;
}

Around packed_around(Surface surface, const UnwrapOptions& options) {
  SerialExecutor serial;
  Unwrapped result = unwrap(std::span(&surface, 1), options, {}, serial);
  return {std::move(surface), std::move(result)};
}

bool is_inside_of(const Around& at, std::size_t face, const Vec2& p) {
  const auto side = [&](std::size_t i) {
    const Vec2 a = at.corner(face, i), way = at.corner(face, (i + 1) % 3) - a;
    return way.x() * (p - a).y() - way.y() * (p - a).x();
  };
  return side(0) > 0 && side(1) > 0 && side(2) > 0;
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 way = b - a;
  const double share = std::clamp((p - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (p - a - share * way).norm();
}

/// The least distance between the sides of two triangles that do not overlap.
double gap(const Around& at, std::size_t s, std::size_t t) {
  double least = 1e9;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      least = std::min(
          {least, distance_to_segment(at.corner(s, i), at.corner(t, j), at.corner(t, (j + 1) % 3)),
           distance_to_segment(at.corner(t, i), at.corner(s, j), at.corner(s, (j + 1) % 3))});
  return least;
}

const std::vector<Sheet> kScattered = {{{.4, .35}, {.25, .3}}, {{.02, .02}, {.3, .2}},
                                       {{.1, .1}, {.2, .2}},   {{.05, .03}, {.15, .35}},
                                       {{0, 0}, {.12, .12}},   {{.3, .2}, {.1, .3}}};

TEST(LockedIslands, KeepTheirUvsAndTheOthersTheirSizesAndGaps) {
  const Around at = packed_around(sheets(kScattered), locking({0, 7}));  // the first and the fourth
  const std::size_t faces = at.surface.mesh.faces.size();
  for (std::size_t t = 0; t < faces; ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 now = at.corner(t, i), was = at.surface.corner_uv[t][i];
      EXPECT_NEAR((now - at.corner(t, (i + 1) % 3)).norm(),
                  (was - at.surface.corner_uv[t][(i + 1) % 3]).norm(), 1e-6);
      const bool is_locked = t / 2 == 0 || t / 2 == 3;
      if (is_locked) {
        EXPECT_EQ(now, was);
        continue;
      }
      EXPECT_GE(std::min(now.minCoeff(), 1 - now.maxCoeff()), 4.0 / 256 - 1e-6);
    }
  for (std::size_t s = 0; s < faces; ++s)
    for (std::size_t t = 0; t < s; ++t)
      if (s / 2 != t / 2) {
        EXPECT_GE(gap(at, s, t), 4.0 / 256 - 1e-6) << s << " and " << t;
      }
  EXPECT_EQ(at.result.report.pages, 1);
  double area = 0;
  for (const Sheet& own : kScattered) area += own.size.prod();
  EXPECT_NEAR(at.result.report.fill, area, 1e-6);
}

/// On a page that is not square lengths count in texels, and numbers that no step divides stay.
TEST(LockedIslands, KeepOddUvsOnAPageThatIsNotSquare) {
  std::vector<Sheet> odd = kScattered;
  odd[0] = {{1.0 / 3, 0.1 + 0.2}, {.3 / 1.1, .1 / 3}};
  UnwrapOptions options = locking({1});
  options.width = 512, options.height = 256;
  options.packing.rotation = Rotation::none;
  const Around at = packed_around(sheets(odd), options);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(at.corner(0, i), at.surface.corner_uv[0][i]);
  const auto texels = [](const Vec2& uv) { return Vec2(512 * uv.x(), 256 * uv.y()); };
  for (std::size_t t = 2; t < at.surface.mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(texels(at.corner(t, i) - at.corner(t, 0)).x(),
                  texels(at.surface.corner_uv[t][i] - at.surface.corner_uv[t][0]).x(), 1e-3);
}

TEST(LockedIslands, LeaveTheOthersFurtherPagesWhereTheseAreAllowed) {
  const std::vector<Sheet> large = {{{.05, .05}, {.8, .8}}, {{0, 0}, {.7, .7}}, {{0, 0}, {.1, .1}}};
  UnwrapOptions options = locking({0});
  try {
    packed_around(sheets(large), options);
    ADD_FAILURE() << "two of .7 and .8 lie on one page";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::does_not_fit);
    EXPECT_EQ(error.where(), "/locked_islands");
  }
  options.packing.max_pages = 3;
  const Around at = packed_around(sheets(large), options);
  EXPECT_EQ(at.result.report.pages, 2);
  EXPECT_GT(at.corner(2, 0).x(), 1);
  std::vector<Sheet> on_second = large;
  on_second[0].low.x() += 1;  // the locked one
  const Around other = packed_around(sheets(on_second), options);
  EXPECT_EQ(other.result.report.pages, 2);
  EXPECT_LT(other.corner(2, 0).x(), 1);
}

/// Nine squares that fill the page to the texel: there is no other way, and none of them moves.
TEST(LockedIslands, LeaveATightPageAsItIsUnlessThePaddingGrows) {
  std::vector<Sheet> tight;
  const double between = 4.0 / 256, side = (1 - 4 * between) / 3, all = side + between;
  for (int k = 0; k < 9; ++k)
    tight.push_back({{between + all * (k % 3), between + all * (k / 3)}, {side, side}});
  const Around at = packed_around(sheets(tight), locking({8}));
  for (std::size_t t = 0; t < at.surface.mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_LT((at.corner(t, i) - at.surface.corner_uv[t][i]).norm(), 1e-6);
  UnwrapOptions wider = locking({8});
  wider.padding = 5;
  EXPECT_THROW(packed_around(sheets(tight), wider), Error);
  for (Sheet& own : tight) own.size *= 0.97;
  tight[4].low += Vec2(between, 0);  // too near to its neighbour: it has to move
  const Around moved = packed_around(sheets(tight), locking({0}));
  for (std::size_t s = 0; s < 18; ++s)
    for (std::size_t t = 0; t < s; ++t)
      if (s / 2 != t / 2) {
        EXPECT_GE(gap(moved, s, t), between - 2e-6) << s << " and " << t;
      }
}

/// Against a rotation by complex numbers, in texels.
TEST(LockedIslands, AreTurnedAboutTheirMiddleAndMoved) {
  std::vector<Sheet> all = kScattered;
  all[0] = {{.1, .2}, {.3, .1}};
  UnwrapOptions options = locking({1, 7});
  options.width = 512, options.height = 256;
  options.locked_islands[0].turn = 30;
  options.locked_islands[0].move = Vec2(.25, .375);
  const Around at = packed_around(sheets(all), options);
  const std::complex<double> middle(512 * .25, 256 * .25), move(512 * .25, 256 * .375);
  const std::complex<double> turn = std::polar(1.0, std::numbers::pi / 6);
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 was = at.surface.corner_uv[t][i];
      const std::complex<double> wanted =
          turn * (std::complex(512 * was.x(), 256 * was.y()) - middle) + middle + move;
      EXPECT_NEAR(512 * at.corner(t, i).x(), wanted.real(), 1e-4);
      EXPECT_NEAR(256 * at.corner(t, i).y(), wanted.imag(), 1e-4);
      EXPECT_EQ(at.corner(6 + t, i), at.surface.corner_uv[6 + t][i]) << "the other one stays";
    }
  for (std::size_t s = 2; s < at.surface.mesh.faces.size(); ++s)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_FALSE(is_inside_of(at, 0, at.corner(s, i)) || is_inside_of(at, 1, at.corner(s, i)));
  EXPECT_EQ(at.result.report.overlaps, 0);
}

TEST(LockedIslands, ThatAreMovedOntoEachOtherAreCounted) {
  UnwrapOptions options = locking({0, 6});  // squares within each other once one is moved
  std::vector<Sheet> all = kScattered;
  all[3] = {{.8, .8}, {.1, .1}};
  const Around apart = packed_around(sheets(all), options);
  EXPECT_EQ(apart.result.report.overlaps, 0);
  options.locked_islands[1].move = all[0].low + Vec2(.1, .02) - all[3].low;
  const Around at = packed_around(sheets(all), options);
  EXPECT_GT(at.result.report.overlaps, 0);
  ASSERT_EQ(at.result.report.notes.size(), 1U);
  EXPECT_EQ(at.result.report.notes[0].code, NoteCode::overlaps);
}

TEST(LockedIslands, AreMovedOntoAPageButNotBeyondIt) {
  std::vector<Sheet> all = kScattered;
  all[0].low = Vec2(-3, .3);
  const Surface surface = sheets(all);
  UnwrapOptions options = locking({0});
  EXPECT_THROW(packed_around(surface, options), Error);
  options.locked_islands[0].move = Vec2(3.4, 0);
  EXPECT_NEAR(packed_around(surface, options).corner(0, 0).x(), .4, 1e-6);
  options.locked_islands[0].move = Vec2(3.9, 0);
  EXPECT_THROW(packed_around(surface, options), Error);
}

TEST(LockedIslands, AreNamedTwiceForOnePlaceAlone) {
  UnwrapOptions options = locking({0, 1});  // the two triangles of one
  options.locked_islands[0].move = options.locked_islands[1].move = Vec2(.05, .01);
  const Around at = packed_around(sheets(kScattered), options);
  EXPECT_LT((at.corner(0, 0) - kScattered[0].low - Vec2(.05, .01)).norm(), 1e-6) << "moved once";
  options.locked_islands[1].turn = 5;
  try {
    packed_around(sheets(kScattered), options);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "/locked_islands/1");
  }
}

TEST(LockedIslands, AreAllOrTheSameForAnyThreads) {
  const Surface surface = sheets(kScattered);
  const Around all = packed_around(surface, locking({0, 2, 4, 6, 8, 10}));
  for (std::size_t t = 0; t < surface.mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(all.corner(t, i), surface.corner_uv[t][i]);
  TwoThreads two;
  const Unwrapped again = unwrap(std::span(&surface, 1), locking({0}), {}, two);
  EXPECT_EQ(again.surfaces[0].uv, packed_around(surface, locking({0})).result.surfaces[0].uv);
}

TEST(LockedIslands, AreRefusedWhereThereAreNoneOrOptionsMoveThem) {
  Surface surface = sheets(kScattered);
  surface.corner_uv[11].fill(Vec2::Constant(std::nan("")));
  const auto where = [&](const std::vector<Index>& faces,
                         const std::function<void(UnwrapOptions&)>& change = {}) -> std::string {
    UnwrapOptions options = locking(faces);
    if (change) change(options);
    try {
      packed_around(surface, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_option);
      return error.where();
    }
    return "none";
  };
  EXPECT_EQ(where({0}), "none");
  EXPECT_EQ(where({0, 12}), "/locked_islands/1");
  EXPECT_EQ(where({0, 2, -1}), "/locked_islands/2");
  EXPECT_EQ(where({11}), "/locked_islands/0") << "it has no UVs";
  EXPECT_EQ(where({0}, [](UnwrapOptions& o) { o.locked_islands[0].surface = 1; }),
            "/locked_islands/0");
  EXPECT_EQ(where({0}, [](UnwrapOptions& o) { o.repack_only = false; }), "/locked_islands");
  EXPECT_EQ(where({0}, [](UnwrapOptions& o) { o.packing.texels_per_unit = 9; }),
            "/texels_per_unit");
  EXPECT_EQ(where({0}, [](UnwrapOptions& o) { o.packing.group = PageGroup::mesh; }), "/group");
  EXPECT_EQ(where({0}, [](UnwrapOptions& o) { o.packing.stack_identical = true; }),
            "/stack_identical");
  for (Vec2& uv : surface.corner_uv[0]) uv.x() += 0.8;
  for (Vec2& uv : surface.corner_uv[1]) uv.x() += 0.8;
  EXPECT_EQ(where({0}), "/locked_islands/0") << "it lies beyond the page";
}

}  // namespace
}  // namespace unwrapd::pipeline
