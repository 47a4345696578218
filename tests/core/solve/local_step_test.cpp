#include "core/solve/local_step.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Jacobian random_jacobian(std::mt19937& rng) {
  std::normal_distribution<double> any;
  return {any(rng), any(rng), any(rng), any(rng)};
}

Eigen::Matrix2d dense(const Jacobian& j) {
  Eigen::Matrix2d m;
  m << j.e + j.f, j.g - j.h, j.h + j.g, j.e - j.f;
  return m;
}

/// Eq. (5) for one triangle of area 1, by the Frobenius norm.
double energy(const Jacobian& j, const Similarity& l, double lambda) {
  Eigen::Matrix2d m;
  m << l.a, l.b, -l.b, l.a;
  const double excess = l.a * l.a + l.b * l.b - 1;
  return (dense(j) - m).squaredNorm() + lambda * excess * excess;
}

TEST(LocalStep, AsapScaleIsTheMeanSignedSingularValue) {  // Sec. 4.1
  std::mt19937 rng(1);
  for (int k = 0; k < 1000; ++k) {
    const Jacobian j = random_jacobian(rng);
    const Similarity l = fit_similarity(j, 0);
    EXPECT_NEAR(std::hypot(l.a, l.b), (j.sigma_max() + j.sigma_min()) / 2, 1e-14);
  }
}

TEST(LocalStep, ArapFitIsTheRotationOfTheSignedSvd) {  // Sec. 4.1
  std::mt19937 rng(2);
  for (int k = 0; k < 1000; ++k) {
    const Jacobian j = random_jacobian(rng);
    const Eigen::JacobiSVD<Eigen::Matrix2d, Eigen::FullPivHouseholderQRPreconditioner> svd(
        dense(j), Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix2d u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(1) *= -1;
    const Eigen::Matrix2d rotation = u * svd.matrixV().transpose();
    const Similarity l = fit_similarity(j, kInfinity);
    EXPECT_NEAR(l.a, rotation(0, 0), 1e-9);
    EXPECT_NEAR(l.b, rotation(0, 1), 1e-9);
  }
}

TEST(LocalStep, NoNearbySimilarityHasLessEnergy) {  // Eq. (5) is minimised, not only stationary
  std::mt19937 rng(4);
  std::normal_distribution<double> bump(0, 0.5);
  for (int k = 0; k < 1000; ++k) {
    const Jacobian j = random_jacobian(rng);
    for (double lambda : {0.0, 1e-6, 0.1, 0.5, 1.0, 2.0, 1e3}) {
      const Similarity best = fit_similarity(j, lambda);
      const Similarity other{best.a + bump(rng), best.b + bump(rng)};
      const double e = energy(j, best, lambda);
      EXPECT_LE(e, energy(j, other, lambda) + 1e-9 * (1 + e)) << lambda;
    }
  }
}

TEST(LocalStep, HybridScaleSolvesItsCubicAlsoAtTheTripleRoot) {  // App. B
  for (double lambda : {1e-9, 0.1, 1.0, 10.0, 1e9})
    for (double q : {0.0, 1e-9, 0.3, 1.0, 1.7, 1e6}) {
      const double r = fit_similarity({q, 0, 0, 0}, lambda).a;
      const double residual = lambda * r * (r * r - 1) + r - q;
      EXPECT_NEAR(residual / (1 + lambda * (1 + r * r * r) + q), 0, 1e-12) << lambda << ' ' << q;
      EXPECT_GE(r, 0);
    }
}

TEST(LocalStep, QuarterTurnsAreNoSpecialCase) {  // C2 = 0, where Eq. (B3) divides by it
  for (double lambda : {0.0, 1.0, kInfinity}) {
    const Similarity l = fit_similarity({0, 1, 0, 0}, lambda);
    EXPECT_NEAR(l.a, 0, 1e-15);
    EXPECT_NEAR(l.b, -1, 1e-12);
  }
}

TEST(LocalStep, FitEnergyIsTheEnergyOfTheFit) {
  std::mt19937 rng(5);
  for (int k = 0; k < 100; ++k) {
    const Jacobian j = random_jacobian(rng);
    for (double lambda : {0.0, 0.7, 30.0}) {
      const Similarity l = fit_similarity(j, lambda);
      EXPECT_NEAR(fit_energy(j, l, 2.5, lambda), 2.5 * energy(j, l, lambda), 1e-9);
    }
  }
}

TEST(LocalStep, ResidualIsMinusTheGradientOfTheEnergy) {  // Eq. (4), by finite differences
  const TriMesh mesh = shapes::random_disk(4, 6);
  const std::vector<RestTriangle> rest = flatten(mesh);
  UvMap uv;
  for (const Vec3& p : mesh.positions) uv.emplace_back(1.2 * p.x() + 0.3 * p.y(), p.y() - p.z());
  SerialExecutor serial;
  for (const Rigidity& rigidity : {Rigidity{}, Rigidity{0.4, false}, Rigidity{0.01, true}}) {
    const std::vector<FaceGroup> groups = face_groups(rest, mesh.faces);
    std::vector<Vec2> residual(12 * groups.size()), scratch(residual.size());
    const auto energy_of = [&](const UvMap& map) {
      return local_step(groups, map, rigidity, scratch, serial).energy;
    };
    local_step(groups, uv, rigidity, residual, serial);
    for (std::size_t v = 0; v < uv.size(); v += 3)
      for (int k : {0, 1}) {
        double sum = 0;
        for (std::size_t c = 0; c < 3 * rest.size(); ++c)
          if (std::size_t(mesh.faces[c / 3][c % 3]) == v) sum += residual[c][k];
        UvMap up = uv, down = uv;
        up[v][k] += 1e-6, down[v][k] -= 1e-6;
        EXPECT_NEAR(sum, -(energy_of(up) - energy_of(down)) / 2e-6, 1e-7);
      }
  }
}

/// Folded over, and one face collapsed to a point.
UvMap folded_map(const TriMesh& mesh) {
  UvMap uv;
  for (const Vec3& p : mesh.positions) uv.emplace_back(p.x() * p.x(), p.y() - 2 * p.z() * p.x());
  for (Index v : mesh.faces[5]) uv[std::size_t(v)] = Vec2(0.3, 0.2);
  return uv;
}

TEST(LocalStep, AddsUpTheFitsOfAllFacesWhateverTheirNumber) {  // groups are filled up
  const TriMesh disk = shapes::random_disk(4, 6);
  const std::vector<RestTriangle> all = flatten(disk);
  const UvMap uv = folded_map(disk);
  SerialExecutor serial;
  for (std::size_t count = 6; count < 12; ++count)
    for (const Rigidity& rigidity : {Rigidity{}, Rigidity{0.4, false}, Rigidity{0.01, true}}) {
      const std::span rest = std::span(all).first(count);
      const std::span faces = std::span<const Triangle>(disk.faces).first(count);
      double energy = 0, area = 0;
      for (std::size_t t = 0; t < count; ++t) {
        const Jacobian j = jacobian(rest[t], uv_edges(faces[t], uv));
        const double lambda = rigidity.at(rest[t].area);
        energy += fit_energy(j, fit_similarity(j, lambda), rest[t].area, lambda);
        area += rest[t].area * std::abs(j.determinant());
      }
      const std::vector<FaceGroup> groups = face_groups(rest, faces);
      std::vector<Vec2> residual(12 * groups.size());
      const LocalSums sums = local_step(groups, uv, rigidity, residual, serial);
      EXPECT_NEAR(sums.energy, energy, 1e-13 * energy);
      EXPECT_NEAR(sums.uv_area, area, 1e-13 * area);
      for (std::size_t c = 3 * count; c < residual.size(); ++c) EXPECT_EQ(residual[c].norm(), 0);
    }
}

TEST(LocalStep, GivesTheSameBitsOnTheBaseline) {
  const TriMesh mesh = shapes::random_disk(9, 7);
  const std::vector<FaceGroup> groups = face_groups(flatten(mesh), mesh.faces);
  const UvMap uv = folded_map(mesh);
  SerialExecutor serial;
  for (const Rigidity& rigidity : {Rigidity{}, Rigidity{0.4, false}, Rigidity{0.01, true}}) {
    std::vector<Vec2> wide(12 * groups.size()), narrow(wide.size());
    const LocalSums a = local_step(groups, uv, rigidity, wide, serial);
    const LocalSums b = local_step_on_baseline(groups, uv, rigidity, narrow, serial);
    EXPECT_EQ(a.energy, b.energy);
    EXPECT_EQ(a.uv_area, b.uv_area);
    EXPECT_EQ(wide, narrow);
  }
}

}  // namespace
}  // namespace unwrapd
