// What holds whatever the method: an answer that is sound, or an error that says why; and by
// default no triangle that is flipped once its UVs are rounded to what a file holds.
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/core/hard_shapes.hpp"

namespace unwrapd {
namespace {

__extension__ using Quad = __float128;  // holds products of differences of floats exactly

constexpr std::array kEveryMethod{Method::asap, Method::arap,   Method::hybrid,
                                  Method::abf,  Method::linabf, Method::cp,
                                  Method::bff,  Method::ic,     Method::slim};

/// Twice the area of the triangle whose corners are rounded to floats, without error.
Quad doubled_area(const UnwrappedSurface& s, const Triangle& face) {
  const auto at = [&](std::size_t corner, int axis) {
    return Quad(static_cast<float>(s.uv[std::size_t(face[corner])][axis]));
  };
  return (at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) -
         (at(1, 1) - at(0, 1)) * (at(2, 0) - at(0, 0));
}

Index flipped_as_written(const Surface& in, const UnwrappedSurface& out) {
  Index flipped = 0;
  for (std::size_t t = 0; t < out.faces.size(); ++t) {
    const auto& [a, b, c] = in.mesh.faces[t];
    const auto at = [&](Index v) { return in.mesh.positions[std::size_t(v)]; };
    const double area = (at(b) - at(a)).cross(at(c) - at(a)).norm();
    if (area > 0 && !(doubled_area(out, out.faces[t]) > 0)) ++flipped;
  }
  return flipped;
}

Unwrapped unwrapped(const Surface& surface, const UnwrapOptions& options) {
  SerialExecutor serial;
  return unwrap(std::vector{surface}, options, {}, serial);
}

void expect_on_the_page(const Unwrapped& u) {
  for (const Vec2& uv : u.surfaces[0].uv)
    EXPECT_TRUE(uv.allFinite() && uv.minCoeff() >= 0 && uv.maxCoeff() <= 1) << uv.transpose();
  EXPECT_GE(u.report.distortion.angle, 2);
  EXPECT_GE(u.report.distortion.area, 2);
}

void expect_kept(const TriMesh& mesh, const UnwrapOptions& options) {
  const Surface surface = shapes::surface_of(mesh);
  try {
    const Unwrapped u = unwrapped(surface, options);
    expect_on_the_page(u);
    EXPECT_EQ(u.report.guarantee, options.guarantee);
    EXPECT_EQ(u.report.distortion.flipped, 0);
    EXPECT_EQ(flipped_as_written(surface, u.surfaces[0]), 0);
  } catch (const Error& e) {
    ADD_FAILURE() << "refused: " << e.what();
  }
}

TEST(EveryMethod, FlipsNothingOnDisksThatAreHardOnASolver) {
  for (const shapes::NamedMesh& hard : shapes::hard_disks())
    for (Method method : kEveryMethod) {
      SCOPED_TRACE(hard.name + ", method " + std::to_string(static_cast<int>(method)));
      expect_kept(hard.mesh, {.method = method});
    }
}

TEST(EveryMethod, FlipsNothingOnRandomDisks) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Index n = 2 + Index(seed * seed) % 29;  // 8 to 1,800 faces
    const TriMesh mesh = seed % 3 == 2 ? shapes::pierced_disk(std::max<Index>(n, 5), seed)
                                       : shapes::random_disk(n, seed);
    for (Method method : kEveryMethod) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", method " +
                   std::to_string(static_cast<int>(method)));
      expect_kept(mesh, {.method = method});
    }
  }
}

TEST(EveryMethod, TakesBrokenSurfaces) {
  for (const shapes::NamedMesh& broken : shapes::broken_surfaces())
    for (Method method : kEveryMethod) {
      SCOPED_TRACE(broken.name + ", method " + std::to_string(static_cast<int>(method)));
      try {
        const UnwrapOptions options{.method = method, .effort = Effort::fast};
        expect_on_the_page(unwrapped(shapes::surface_of(broken.mesh), options));
      } catch (const Error& e) {
        ADD_FAILURE() << "refused: " << e.what();
      }
    }
}

TEST(EveryMethod, StopsWhenAsked) {
  for (Method method : kEveryMethod) {
    std::stop_source stop;
    Progress progress;
    progress.stop = stop.get_token();
    int solved = 0;
    progress.on_stage = [&](const StageEvent& e) {
      if (e.stage != Stage::solve) return;
      stop.request_stop();
      ++solved;
    };
    SerialExecutor serial;
    const std::vector<Surface> surfaces{shapes::surface_of(shapes::random_disk(15, 3)),
                                        shapes::surface_of(shapes::random_disk(15, 4))};
    EXPECT_THROW(unwrap(surfaces, {.method = method}, progress, serial), Error)
        << static_cast<int>(method);
    EXPECT_EQ(solved, 1) << static_cast<int>(method);
  }
}

TEST(EveryMethod, GivesTheSameMapAtAnyScaleAndPlace) {
  const TriMesh mesh = shapes::random_disk(9, 8);
  for (Method method : kEveryMethod) {
    const Report here = unwrapped(shapes::surface_of(mesh), {.method = method}).report;
    TriMesh other = mesh;
    for (Vec3& p : other.positions) p = 1e-4 * p + Vec3(3, -7, 11);
    const Report there = unwrapped(shapes::surface_of(other), {.method = method}).report;
    EXPECT_NEAR(here.distortion.angle, there.distortion.angle, 1e-6) << static_cast<int>(method);
    EXPECT_NEAR(here.distortion.area, there.distortion.area, 1e-6) << static_cast<int>(method);
  }
}

}  // namespace
}  // namespace unwrapd
