#include "core/unwrap.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <array>
#include <limits>
#include <map>
#include <set>

#include "core/base/error.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/shapes.hpp"
#include "tests/samples/sanitized.hpp"

namespace unwrapd {
namespace {

Unwrapped unwrapped(std::vector<Surface> surfaces, const UnwrapOptions& options = {},
                    const Progress& progress = {}) {
  SerialExecutor serial;
  return unwrap(surfaces, options, progress, serial);
}

Unwrapped unwrapped(const TriMesh& mesh, const UnwrapOptions& options = {}) {
  return unwrapped(std::vector{shapes::surface_of(mesh)}, options);
}

double signed_uv_area(const UnwrappedSurface& s, const Triangle& face) {
  const Vec2 &a = s.uv[std::size_t(face[0])], &b = s.uv[std::size_t(face[1])],
             &c = s.uv[std::size_t(face[2])];
  return ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x()) / 2;
}

/// Every face keeps its corners' input vertices, every UV lies on the page.
void expect_sound(const Surface& in, const UnwrappedSurface& out) {
  ASSERT_EQ(out.faces.size(), in.mesh.faces.size());
  ASSERT_EQ(out.source.size(), out.uv.size());
  for (Index v = 0; v < in.mesh.vertex_count(); ++v) ASSERT_EQ(out.source[std::size_t(v)], v);
  for (std::size_t t = 0; t < out.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(out.source[std::size_t(out.faces[t][i])], in.mesh.faces[t][i]);
  for (const Vec2& u : out.uv) {
    EXPECT_TRUE(u.allFinite());
    EXPECT_TRUE(u.minCoeff() >= 0 && u.maxCoeff() <= 1) << u.transpose();
  }
}

TEST(Unwrap, AnswersEveryKindOfSurface) {
  const std::vector<TriMesh> parts{shapes::grid(3, 3), shapes::moved(shapes::cube(1), {5, 0, 0})};
  for (const TriMesh& mesh :
       {shapes::grid(4, 4), shapes::annulus(12, 3), shapes::cylinder(12, 4), shapes::cube(2),
        shapes::sphere(3), shapes::torus(24, 12), shapes::pierced_bar(2), shapes::bow_tie(),
        shapes::three_faces_at_an_edge(), shapes::soup(shapes::sphere(2)), shapes::merged(parts)}) {
    const Surface surface = shapes::surface_of(mesh);
    const Unwrapped u = unwrapped({surface}, {.guarantee = Guarantee::bijective});  // fill: once
    expect_sound(surface, u.surfaces.front());
    EXPECT_GT(u.report.fill, 0.1);
    EXPECT_LE(u.report.fill, 1);
  }
}

TEST(Unwrap, GivesOneTexelDensityToAllCharts) {
  std::vector<Surface> surfaces{shapes::surface_of(shapes::grid(3, 3, 4, 1)),
                                shapes::surface_of(shapes::sphere(3)),
                                shapes::surface_of(shapes::grid(2, 2, 0.1, 0.1))};
  const Unwrapped u = unwrapped(surfaces);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    double in = 0, out = 0;
    for (std::size_t t = 0; t < surfaces[s].mesh.faces.size(); ++t) {
      const Triangle& f = surfaces[s].mesh.faces[t];
      const auto at = [&](std::size_t i) { return surfaces[s].mesh.positions[std::size_t(f[i])]; };
      const Vec3 ab = at(1) - at(0), ac = at(2) - at(0);
      in += std::sqrt(ab.squaredNorm() * ac.squaredNorm() - std::pow(ab.dot(ac), 2)) / 2;
      out += std::abs(signed_uv_area(u.surfaces[s], u.surfaces[s].faces[t]));
    }
    EXPECT_NEAR(std::sqrt(out / in) * 1024 / u.report.texel_density, 1, 1e-5);  // UVs are rounded
  }
}

/// D_angle and D_area of a surface from |J|^2 and |det J|, by sides and angles in space.
std::array<double, 2> distortion_written(const Surface& in, const UnwrappedSurface& out) {
  double area = 0, image = 0, inverse = 0, angle = 0;
  for (std::size_t t = 0; t < out.faces.size(); ++t) {
    const auto at = [&](std::size_t i) {
      return in.mesh.positions[std::size_t(in.mesh.faces[t][i])];
    };
    const auto uv = [&](std::size_t i) { return out.uv[std::size_t(out.faces[t][i])]; };
    const Vec3 ab = at(1) - at(0), ac = at(2) - at(0);
    const double own = ab.cross(ac).norm() / 2, length = ab.norm();
    const Vec2 along = (uv(1) - uv(0)) / length;
    const Vec2 across = (uv(2) - uv(0) - along * (ab.dot(ac) / length)) / (2 * own / length);
    const double det = std::abs(along.x() * across.y() - along.y() * across.x());
    area += own, image += own * det, inverse += own / det;
    angle += own * (along.squaredNorm() + across.squaredNorm()) / det;
  }
  return {angle / area, 1 + image * inverse / (area * area)};
}

TEST(Unwrap, MeasuresDistortionAsItIsWritten) {
  TriMesh tiny = shapes::random_disk(60, 5);  // some fifty steps wide on the page
  for (Vec3& p : tiny.positions) p *= 3e-6;
  const Surface part = shapes::surface_of(tiny);
  UnwrapOptions options;
  options.packing.texels_per_unit = 0.9 * options.resolution;  // else it is enlarged
  const Unwrapped u = unwrapped({part, shapes::surface_of(shapes::grid(2, 2))}, options);
  const auto [angle, area] = distortion_written(part, u.surfaces[0]);
  EXPECT_GT(angle, 2.05);  // of the map before it is rounded: 2.01
  EXPECT_NEAR(u.report.charts[0].distortion.angle, angle, 1e-6 * angle);
  EXPECT_NEAR(u.report.charts[0].distortion.area, area, 1e-6 * area);
}

TEST(Unwrap, SaysWhichMapsAreNotTheMethodsOwn) {
  const Surface ramp = shapes::surface_of(  // more than a turn, which lies flat on itself
      shapes::mapped_grid(96, 4, shapes::Wrap::none, [](double u, double v) {
        const double angle = shapes::kTurn * 1.6 * u, radius = 1 + 0.5 * (1 - v);
        return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0.6 * u);
      }));
  const auto says_so = [](const Report& report) {
    return std::ranges::count(report.notes, NoteCode::chart_remapped, &Note::code) == 1;
  };
  for (const Method method : {Method::arap, Method::slim, Method::abf, Method::hybrid}) {
    const Report free = unwrapped({ramp}, {.method = method}).report;
    const Report apart =
        unwrapped({ramp}, {.method = method, .guarantee = Guarantee::bijective}).report;
    EXPECT_FALSE(says_so(free));
    EXPECT_EQ(says_so(apart), apart.charts[0].mending.overlaps > 0);
    EXPECT_EQ(apart.charts[0].overlaps, 0);
    EXPECT_GE(apart.charts[0].mending.energy_rise, 0);
    EXPECT_TRUE(says_so(apart) || (method != Method::arap && method != Method::slim));
  }
}

TEST(Unwrap, CountsInItsReportWhatItAnswered) {
  const Unwrapped u = unwrapped(shapes::sphere(3));
  EXPECT_EQ(u.report.input.faces, 512);
  EXPECT_EQ(u.report.input.components, 1);
  EXPECT_EQ(u.report.input.boundaries, 0);
  Index faces = 0;
  double seams = 0;
  for (const ChartReport& chart : u.report.charts) {
    EXPECT_EQ(chart.overlaps, 0);
    faces += chart.faces;
    seams += chart.seam_length;
  }
  EXPECT_EQ(faces, 512);
  EXPECT_EQ(u.report.overlaps, 0);
  EXPECT_LE(u.report.distortion.angle, kDefaultDistortion);
  EXPECT_LE(u.report.distortion.area, kDefaultDistortion);
  EXPECT_NEAR(seams, 2 * u.report.seam_length, 1e-9);  // each seam has two sides
  EXPECT_NEAR(u.report.seam_ratio, u.report.seam_length / std::sqrt(u.report.area), 1e-12);
  Index flipped = 0;
  double fill = 0;
  for (const Triangle& face : u.surfaces[0].faces) {
    flipped += signed_uv_area(u.surfaces[0], face) <= 0 ? 1 : 0;
    fill += std::abs(signed_uv_area(u.surfaces[0], face));
  }
  EXPECT_EQ(u.report.distortion.flipped, flipped);
  EXPECT_NEAR(u.report.fill, fill, 1e-6);  // UVs are rounded
  EXPECT_GT(u.report.seam_length, 1);      // a sphere does not open without a seam
}

TEST(Unwrap, TotalsAreTheAreaWeightedMeansOfItsCharts) {
  std::vector<Surface> surfaces{shapes::surface_of(shapes::sphere(2)),
                                shapes::surface_of(shapes::cone(20, 5, 3))};
  const Report r = unwrapped(surfaces).report;
  double area = 0, angle = 0, d_area = 0;
  for (const ChartReport& c : r.charts) {
    area += c.area, angle += c.area * c.distortion.angle, d_area += c.area * c.distortion.area;
  }
  EXPECT_NEAR(r.distortion.angle, angle / area, 1e-9);
  EXPECT_NEAR(r.distortion.area, d_area / area, 1e-7);  // rounding scales each chart anew
}

TEST(Unwrap, SeamLengthIsThatOfTheCutBruteForce) {
  const TriMesh mesh = shapes::torus(20, 10);
  const Unwrapped u = unwrapped(mesh);
  std::map<std::pair<Index, Index>, std::set<std::pair<double, double>>> sides;
  const UnwrappedSurface& s = u.surfaces[0];
  for (std::size_t t = 0; t < mesh.faces.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = mesh.faces[t][i], b = mesh.faces[t][(i + 1) % 3];
      const Vec2 sum =
          s.uv[std::size_t(s.faces[t][i])] + s.uv[std::size_t(s.faces[t][(i + 1) % 3])];
      sides[std::minmax(a, b)].insert({sum.x(), sum.y()});
    }
  double length = 0;
  for (const auto& [edge, uv] : sides)
    if (uv.size() > 1)
      length += (mesh.positions[std::size_t(edge.first)] - mesh.positions[std::size_t(edge.second)])
                    .norm();
  EXPECT_NEAR(u.report.seam_length, length, 1e-9);
}

TEST(Unwrap, TellsProgressThatNeverGoesBack) {
  double last = 0;
  int iterations = 0;
  Progress progress;
  progress.on_stage = [&](const StageEvent& e) {
    EXPECT_GE(e.fraction, last);
    last = e.fraction;
  };
  progress.on_iteration = [&](const IterationEvent& e) {
    EXPECT_GE(e.fraction, last);
    EXPECT_GE(e.rel_change, -1e-12);
    EXPECT_GE(e.angle, 2);
    last = e.fraction;
    ++iterations;
  };
  const Unwrapped u =
      unwrapped({shapes::surface_of(shapes::sphere(3)), shapes::surface_of(shapes::cone(20, 5))},
                {}, progress);
  int told = 0;
  for (const ChartReport& chart : u.report.charts) told += chart.iterations;
  EXPECT_EQ(iterations, told);
  EXPECT_LE(last, 1);
}

TEST(Unwrap, StopsWhenAsked) {
  std::stop_source stop;
  Progress progress;
  progress.stop = stop.get_token();
  progress.on_iteration = [&](const IterationEvent&) { stop.request_stop(); };
  EXPECT_THROW(unwrapped({shapes::surface_of(shapes::sphere(3))}, {}, progress), Error);
}

ErrorCode refusal(const TriMesh& mesh, const UnwrapOptions& options = {}) {
  try {
    unwrapped(mesh, options);
  } catch (const Error& e) {
    return e.code();
  }
  return ErrorCode::internal;
}

TEST(Unwrap, OfAMeshOfAnySizeIsTheSameOrRefused) {
  const UnwrapOptions options{.max_distortion = kDefaultDistortion, .effort = Effort::fast};
  const Report of_one = unwrapped(shapes::sphere(1), options).report;
  for (const int exponent : {30, 5, 3, 2, 1, -1, -3, -30, -60, -70, -80, -90, -120, -200, -300}) {
    TriMesh mesh = shapes::sphere(1);
    for (Vec3& p : mesh.positions) p *= std::pow(10.0, exponent);
    SCOPED_TRACE(exponent);
    if (exponent < -75) {
      EXPECT_EQ(refusal(mesh, options), ErrorCode::zero_area);
      continue;
    }
    const Report report = unwrapped(mesh, options).report;
    EXPECT_EQ(report.charts.size(), of_one.charts.size());
    EXPECT_NEAR(report.distortion.angle, of_one.distortion.angle, 1e-6);
  }
}

TEST(Unwrap, RefusesWhatCannotBeDone) {
  const TriMesh line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(refusal(line), ErrorCode::zero_area);
  EXPECT_EQ(refusal(shapes::mobius_strip(20)), ErrorCode::not_orientable);
  EXPECT_EQ(refusal({}), ErrorCode::no_triangles);
  const TriMesh mesh = shapes::grid(2, 2);
  EXPECT_EQ(refusal(mesh, {.method = Method::hybrid, .lambda = -1}), ErrorCode::invalid_option);
  EXPECT_EQ(refusal(mesh, {.method = Method::hybrid, .lambda = std::nan("")}),
            ErrorCode::invalid_option);
  EXPECT_EQ(refusal(mesh, {.stop = {.iterations = 0}}), ErrorCode::invalid_option);
  EXPECT_EQ(refusal(mesh, {.resolution = 8}), ErrorCode::invalid_option);
  EXPECT_EQ(refusal(mesh, {.resolution = 64, .padding = 17}), ErrorCode::invalid_option);
}

TEST(Unwrap, GivesDegenerateFacesUvsAndSaysSo) {
  TriMesh mesh = shapes::grid(3, 3);
  mesh.faces.push_back({0, 1, 1});
  mesh.faces.push_back(mesh.faces[0]);
  const Surface surface = shapes::surface_of(mesh);
  const Unwrapped u = unwrapped({surface});
  expect_sound(surface, u.surfaces[0]);
  std::set<RepairKind> kinds;
  for (const Repair& r : u.report.repairs) kinds.insert(r.kind);
  EXPECT_TRUE(kinds.contains(RepairKind::degenerate_faces_set_aside));
  EXPECT_TRUE(kinds.contains(RepairKind::duplicate_faces_set_aside));
}

TEST(Unwrap, AnswersEveryRealMeshOrSaysWhyNot) {
  const std::filesystem::path data = test_data();
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no test data at " << data;
  const Index most_faces =  // under a sanitizer larger ones take minutes
      is_sanitized() ? 3000 : std::numeric_limits<Index>::max();
  for (const char* folder : {"disk", "closed"})
    for (const auto& entry : std::filesystem::directory_iterator(data / folder)) {
      SCOPED_TRACE(entry.path().filename().string());
      const Surface surface = shapes::surface_of(read_obj(entry.path()));
      if (surface.mesh.face_count() > most_faces) continue;
      try {
        expect_sound(surface, unwrapped({surface}).surfaces[0]);
      } catch (const Error& e) {
        EXPECT_TRUE(e.code() == ErrorCode::zero_area || e.code() == ErrorCode::not_orientable)
            << e.what();
      }
    }
}

}  // namespace
}  // namespace unwrapd
