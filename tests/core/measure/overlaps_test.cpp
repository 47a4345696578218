#include "core/measure/overlaps.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "core/measure/orientation.hpp"
#include "core/measure/winding.hpp"
#include "tests/core/solve/disk_of.hpp"

namespace unwrapd::measure {
namespace {

using Corners = std::array<Vec2, 3>;

/// Area of the part of polygon p that is inside the counter-clockwise triangle t (clipping).
double common_area(std::vector<Vec2> p, const Corners& t) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 a = t[i], d = t[(i + 1) % 3] - a;
    const auto side = [&](const Vec2& q) { return d.x() * (q - a).y() - d.y() * (q - a).x(); };
    std::vector<Vec2> cut;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Vec2 &q = p[k], &r = p[(k + 1) % p.size()];
      if (side(q) >= 0) cut.push_back(q);
      if (side(q) * side(r) < 0) cut.push_back(q + (r - q) * side(q) / (side(q) - side(r)));
    }
    p = cut;
  }
  double area = 0;
  for (std::size_t k = 2; k < p.size(); ++k) {
    const Vec2 a = p[k - 1] - p[0], b = p[k] - p[0];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  return area;
}

UvMap from_above(const TriMesh& mesh) { return shapes::from_above(mesh.positions); }

TEST(Overlap, AgreesWithTheAreaInCommon) {
  std::mt19937 rng(1);
  std::uniform_int_distribution<int> at(0, 6);  // small lattice: touching sides and corners abound
  int met = 0, touched = 0;
  for (int k = 0; k < 50000; ++k) {
    Corners a, b;
    for (Vec2& p : a) p = Vec2(at(rng), at(rng));
    for (Vec2& p : b) p = Vec2(at(rng), at(rng));
    const bool found = overlap(a, b);
    if (orientation(a[0], a[1], a[2]) < 0) std::swap(a[1], a[2]);
    if (orientation(b[0], b[1], b[2]) < 0) std::swap(b[1], b[2]);
    const bool have_interiors =
        orientation(a[0], a[1], a[2]) != 0 && orientation(b[0], b[1], b[2]) != 0;
    const bool expected = have_interiors && common_area({a.begin(), a.end()}, b) > 1e-9;
    ASSERT_EQ(found, expected) << k;
    (found ? met : touched) += 1;
  }
  EXPECT_GT(met, 5000);
  EXPECT_GT(touched, 5000);
}

std::vector<std::array<Index, 2>> pairs_by_brute_force(const TriMesh& mesh, const UvMap& uv) {
  std::vector<std::array<Index, 2>> pairs;
  const auto corners = [&](Index t) {
    const auto& [a, b, c] = mesh.faces[std::size_t(t)];
    return Corners{uv[std::size_t(a)], uv[std::size_t(b)], uv[std::size_t(c)]};
  };
  for (Index s = 0; s < mesh.face_count(); ++s)
    for (Index t = s + 1; t < mesh.face_count(); ++t)
      if (overlap(corners(s), corners(t))) pairs.push_back({s, t});
  return pairs;
}

TEST(Overlap, FindsThePairsThatBruteForceFinds) {
  std::size_t found = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const TriMesh mesh = shapes::random_disk(7, seed);
    const UvMap uv = shapes::shaken(from_above(mesh), 0.02 * seed, seed);
    const auto expected = pairs_by_brute_force(mesh, uv);
    EXPECT_EQ(overlapping_pairs(mesh.faces, uv, 1 << 20), expected);
    EXPECT_EQ(overlapping_pairs(mesh.faces, uv, 3).size(),
              std::min<std::size_t>(3, expected.size()));
    found += expected.size();
  }
  EXPECT_GT(found, 100U);
}

/// A strip of n quads whose ends lie upon each other where it is bent by more than a turn.
TriMesh bent_strip(double turn) {
  return shapes::mapped_grid(40, 2, shapes::Wrap::none, [&](double u, double v) {
    const double r = 2 + v, angle = turn * u;
    return Vec3(r * std::cos(angle), r * std::sin(angle), u);
  });
}

std::vector<BoundaryLoop> loops_of(const TriMesh& mesh) {
  return boundary_loops(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
}

bool is_plainly_injective(const TriMesh& mesh, const UvMap& uv) {
  return unwrapd::measure::is_plainly_injective(mesh.faces, loops_of(mesh), uv);
}

TEST(PlainlyInjective, SeesABoundaryThatCrossesItself) {
  for (double turn : {4.0, 6.2, 6.5, 9.0}) {
    TriMesh mesh = bent_strip(turn);
    for (Triangle& face : mesh.faces) std::swap(face[1], face[2]);
    const UvMap uv = from_above(mesh);
    ASSERT_TRUE(flipped_faces(mesh.faces, uv).empty());
    EXPECT_EQ(is_plainly_injective(mesh, uv), turn < shapes::kTurn) << turn;
    EXPECT_EQ(overlapping_pairs(mesh.faces, uv, 1 << 20).empty(), turn < shapes::kTurn) << turn;
  }
}

TEST(PlainlyInjective, TakesHolesThatLieWhereTheyShould) {
  TriMesh ring = shapes::annulus(24, 3);
  for (Triangle& face : ring.faces)
    if (orientation(face, from_above(ring)) < 0) std::swap(face[1], face[2]);
  UvMap uv = from_above(ring);
  ASSERT_TRUE(flipped_faces(ring.faces, uv).empty());
  EXPECT_TRUE(is_plainly_injective(ring, uv));
  for (Vec2& u : uv) u.x() = -u.x();
  EXPECT_FALSE(is_plainly_injective(ring, uv));
}

TEST(PlainlyInjective, IsNotFooledByADoubleCover) {
  // every point twice: angles doubled around the hole of a ring
  TriMesh ring = shapes::annulus(48, 2);
  UvMap uv;
  for (const Vec3& p : ring.positions) {
    const double angle = 2 * std::atan2(p.y(), p.x()), r = std::hypot(p.x(), p.y());
    uv.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  if (!flipped_faces(ring.faces, uv).empty())
    for (Triangle& face : ring.faces) std::swap(face[1], face[2]);
  ASSERT_TRUE(flipped_faces(ring.faces, uv).empty());
  EXPECT_FALSE(is_plainly_injective(ring, uv));
  EXPECT_GE(overlapping_pairs(ring.faces, uv, 1 << 20).size(), ring.faces.size() / 2);
}

/// A map of a sheet without flips: v goes around `turn`, at radii from 1 on, and is bent besides.
TriMesh fanned_out(double turn, double wave) {
  return shapes::mapped_grid(30, 30, shapes::Wrap::none, [&](double u, double v) {
    const double r = 1 + u + wave * std::sin(9 * v), angle = turn * v;
    return Vec3(r * std::cos(angle), r * std::sin(angle), 0);
  });
}

std::size_t expect_same_pairs(const TriMesh& mesh, const UvMap& uv) {
  const auto expected = overlapping_pairs(mesh.faces, uv, 1 << 20);
  const auto loops = loops_of(mesh);
  EXPECT_EQ(overlapping_pairs(mesh.faces, loops, uv, 1 << 20), expected);
  EXPECT_EQ(overlapping_pairs(mesh.faces, loops, uv, 5).size(),
            std::min<std::size_t>(5, expected.size()));
  return expected.size();
}

TEST(Overlap, IsSoughtOnlyWhereTheBoundaryWindsMoreThanOnceOrComesNear) {
  std::size_t found = 0;
  for (double turn : {3.0, 6.2, 6.3, 7.0, 13.0, 20.0})
    for (double wave : {0.0, 0.1, 0.3})
      for (double tilt : {0.0, 0.7, 2.0}) {  // rows and columns of the grid at other places
        const TriMesh mesh = fanned_out(turn, wave);
        UvMap uv = from_above(mesh);
        for (Vec2& u : uv) u = Eigen::Rotation2Dd(tilt) * u;
        ASSERT_TRUE(flipped_faces(mesh.faces, uv).empty());
        const std::size_t own = expect_same_pairs(mesh, uv);
        EXPECT_EQ(own > 0, turn > shapes::kTurn);
        found += own;
        const auto perhaps = faces_perhaps_overlapped(mesh.faces, loops_of(mesh), uv);
        EXPECT_LT(perhaps.size(), (turn < shapes::kTurn ? 0.6 : 1.1) * double(mesh.faces.size()));
      }
  EXPECT_GT(found, 10000U);
}

TEST(Overlap, IsSoughtAroundHolesAndAmongFlipsAsWell) {
  TriMesh ring = shapes::annulus(48, 8);
  for (int turns : {1, 2, 3}) {
    UvMap uv;
    for (const Vec3& p : ring.positions) {
      const double angle = turns * std::atan2(p.y(), p.x()), r = std::hypot(p.x(), p.y());
      uv.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
    if (!flipped_faces(ring.faces, uv).empty())
      for (Triangle& face : ring.faces) std::swap(face[1], face[2]);
    ASSERT_TRUE(flipped_faces(ring.faces, uv).empty());
    EXPECT_EQ(expect_same_pairs(ring, uv) > 0, turns > 1);
    EXPECT_GT(expect_same_pairs(ring, shapes::shaken(uv, 0.1, 1)), 0U);
  }
}

TEST(PlainlyInjective, NeverContradictsTheCount) {
  int proofs = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const TriMesh mesh = shapes::random_disk(4, seed);
    const UvMap uv = shapes::shaken(from_above(mesh), 0.003 * seed, seed);
    const bool none = overlapping_pairs(mesh.faces, uv, 1).empty();
    if (is_plainly_injective(mesh, uv)) {
      ++proofs;
      EXPECT_TRUE(none);
    } else {
      EXPECT_FALSE(none && flipped_faces(mesh.faces, uv).empty());
    }
  }
  EXPECT_GT(proofs, 5);
}

}  // namespace
}  // namespace unwrapd::measure
