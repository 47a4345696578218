// Seams of a surface with a mirror plane.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/segment/base/segmentation_mesh.hpp"
#include "core/segment/mirror.hpp"
#include "core/segment/segment_symmetrically.hpp"
#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment {
namespace {

/// A closed body with four lobes and a neck, symmetric about a plane; turned and moved by the seed.
TriMesh body(unsigned seed) {
  TriMesh mesh = shapes::sphere(3);
  const double a = 3 + 0.5 * (seed % 4), b = 1 + seed % 3;
  for (Vec3& p : mesh.positions) {
    const double side = std::abs(p.x());
    p *= 1 + 0.5 * std::sin(a * p.z() + b) * side + 0.3 * std::cos(4 * side + 2 * p.y());
    p = Vec3(2 * p.x(), p.y(), 1.5 * p.z()) + Vec3(0.1 * seed, -3, 7);
  }
  return mesh;
}

struct Sample {
  explicit Sample(const TriMesh& mesh) : given(shapes::surface_of(mesh)) {
    component = charts::components_of(given, {}).charts.at(0);
    surface = make_segmentation_mesh(component.mesh, component.halfedges, component.crease);
    mirror = find_mirror(surface.mesh, surface.halfedges);
  }
  [[nodiscard]] std::optional<Segments> segments(double bound = 2.02) const {
    SerialExecutor serial;
    SegmentRules rules{.max_distortion = bound, .effort = Effort::fast};
    return segment_symmetrically(component, surface, *mirror, rules, serial);
  }

  Surface given;
  charts::Chart component;
  SegmentationMesh surface;
  std::optional<Mirror> mirror;
};

/// One a half-edge, 1: a seam.
std::vector<char> seams_of(const SegmentationMesh& surface, const Segments& segments) {
  std::vector<std::size_t> owner(surface.rest.size());
  for (std::size_t k = 0; k < segments.regions.size(); ++k)
    for (const Index t : segments.regions[k].faces) owner[t] = k;
  std::vector<char> seam = segments.open;
  for (std::size_t h = 0; h < seam.size(); ++h)
    if (owner[h / 3] != owner[surface.halfedges.twin[h] / 3]) seam[h] = 1;
  return seam;
}

TEST(Mirror, MapsHalfEdgesOntoHalfEdgesOfTheOtherSide) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Sample sample(body(seed));
    ASSERT_TRUE(sample.mirror) << seed;
    const Mirror& mirror = *sample.mirror;
    for (std::size_t h = 0; h < mirror.halfedge.size(); ++h) {
      ASSERT_GE(mirror.halfedge[h], 0);
      EXPECT_EQ(mirror.halfedge[mirror.halfedge[h]], static_cast<Index>(h));
      EXPECT_NE(mirror.is_front[h / 3], mirror.is_front[mirror.halfedge[h] / 3]);
    }
  }
}

TEST(Mirror, BearsNoiseWithinItsTolerance) {
  const auto is_found = [](double noise) {
    TriMesh mesh = body(1);
    std::mt19937 rng(1);
    std::uniform_real_distribution<double> bump(-noise, noise);
    for (Vec3& p : mesh.positions) p += Vec3(bump(rng), bump(rng), bump(rng));
    return Sample(mesh).mirror.has_value();
  };
  EXPECT_TRUE(is_found(1e-4));
  EXPECT_FALSE(is_found(0.1));
}

TEST(Mirror, IsNotFoundWhereThereIsNone) {
  TriMesh mesh = shapes::sphere(2);
  for (Vec3& p : mesh.positions)
    p = Vec3(p.x() * (2 + p.y()), p.y() * (3 + p.z()), p.z() * (1.5 + 0.5 * p.x()));
  EXPECT_FALSE(Sample(mesh).mirror);
}

/// The long triangles of a tube's wall have their middles on either side of the plane halfway up.
TEST(Mirror, DoesNotPartTheWallOfATubeIntoTeeth) {
  TriMesh tube = shapes::cylinder(60, 1, 1, 12);
  for (Vec3& p : tube.positions) p = {p.z(), p.x(), p.y()};
  const Sample sample(tube);
  ASSERT_TRUE(sample.mirror);
  EXPECT_LT(std::abs(sample.mirror->normal.x()), 0.1);
}

TEST(SegmentSymmetrically, SeamsAreTheirOwnImage) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Sample sample(body(seed));
    const auto segments = sample.segments();
    ASSERT_TRUE(segments) << seed;
    const std::vector<char> seam = seams_of(sample.surface, *segments);
    EXPECT_GT(std::ranges::count(seam, 1), 0);
    for (std::size_t h = 0; h < seam.size(); ++h)
      ASSERT_EQ(seam[h], seam[sample.mirror->halfedge[h]]) << seed;
    std::vector<int> times(sample.surface.rest.size(), 0);
    for (const Region& region : segments->regions)
      for (const Index t : region.faces) ++times[t];
    EXPECT_EQ(std::ranges::count(times, 1), std::ssize(times));
    EXPECT_LE(segments->excess.worst(), 0.02);
  }
}

TEST(SegmentSymmetrically, JoinsRegionsAcrossThePlane) {  // else every region is on one side
  std::ptrdiff_t joined = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Sample sample(seed == 0 ? shapes::torus(32, 16) : body(seed));
    const Segments segments = sample.segments().value();
    joined += std::ranges::count_if(segments.regions, [&](const Region& region) {
      const char first = sample.mirror->is_front[region.faces.front()];
      return std::ranges::any_of(region.faces,
                                 [&](Index t) { return sample.mirror->is_front[t] != first; });
    });
  }
  EXPECT_GT(joined, 0);
}

TEST(SegmentSymmetrically, ALooserBoundHasNoLongerSeams) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Sample sample(body(seed));
    double last = 1e9;
    for (const double bound : {2.02, 2.05, 2.2}) {
      const double length = sample.segments(bound).value().seam_length;
      EXPECT_LE(length, last) << seed << ", " << bound;
      last = length;
    }
  }
}

/// A face that lies across the plane, as three of a tetrahedron's may, has another one's image.
TEST(SegmentSymmetrically, KeepsEveryPromiseOfAnUnwrap) {
  TriMesh tetrahedron;
  tetrahedron.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (const TriMesh& mesh : {tetrahedron, body(2), shapes::torus(24, 12)}) {
    UnwrapOptions options{.max_distortion = 2.02, .guarantee = Guarantee::bijective};
    options.symmetry = Symmetry::automatic;
    options.effort = Effort::fast;
    SerialExecutor serial;
    const std::vector<Surface> surfaces{shapes::surface_of(mesh)};
    const Report report = unwrap(surfaces, options, {}, serial).report;
    EXPECT_GT(report.charts.size(), mesh.faces.size() > 4 ? 1U : 0U);
    EXPECT_EQ(report.distortion.flipped, 0);
    EXPECT_EQ(report.overlaps, 0);
    EXPECT_LE(std::max(report.distortion.angle, report.distortion.area), 2.02 + 1e-6);
  }
}

}  // namespace
}  // namespace unwrapd::segment
