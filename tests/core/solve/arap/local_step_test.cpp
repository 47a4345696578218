#include "core/solve/arap/local_step.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/solve/arap/global_step.hpp"
#include "tests/core/shapes.hpp"
#include "tests/core/solve/ranks.hpp"
#include "tests/core/two_threads.hpp"

namespace unwrapd::solve::arap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

measure::Jacobian random_jacobian(std::mt19937& rng) {
  std::normal_distribution<double> any;
  return {any(rng), any(rng), any(rng), any(rng)};
}

Eigen::Matrix2d dense(const measure::Jacobian& j) {
  Eigen::Matrix2d m;
  m << j.e + j.f, j.g - j.h, j.h + j.g, j.e - j.f;
  return m;
}

/// Eq. (5) for one triangle of area 1, by the Frobenius norm.
double energy(const measure::Jacobian& j, const Similarity& l, double lambda) {
  Eigen::Matrix2d m;
  m << l.a, l.b, -l.b, l.a;
  const double excess = l.a * l.a + l.b * l.b - 1;
  return (dense(j) - m).squaredNorm() + lambda * excess * excess;
}

TEST(LocalStep, AsapScaleIsTheMeanSignedSingularValue) {  // Sec. 4.1
  std::mt19937 rng(1);
  for (int k = 0; k < 1000; ++k) {
    const measure::Jacobian j = random_jacobian(rng);
    const Similarity l = fit_similarity(j, 0);
    EXPECT_NEAR(std::hypot(l.a, l.b), (j.sigma_max() + j.sigma_min()) / 2, 1e-14);
  }
}

TEST(LocalStep, ArapFitIsTheRotationOfTheSignedSvd) {  // Sec. 4.1
  std::mt19937 rng(2);
  for (int k = 0; k < 1000; ++k) {
    const measure::Jacobian j = random_jacobian(rng);
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
    const measure::Jacobian j = random_jacobian(rng);
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
    const measure::Jacobian j = random_jacobian(rng);
    for (double lambda : {0.0, 0.7, 30.0}) {
      const Similarity l = fit_similarity(j, lambda);
      EXPECT_NEAR(fit_energy(j, l, 2.5, lambda), 2.5 * energy(j, l, lambda), 1e-9);
    }
  }
}

/// What a local step reads and writes.
struct Fitted {
  FaceBlocks blocks;
  std::vector<Vec2> force, beyond;
  LocalSums sums;

  Fitted(std::span<const measure::RestTriangle> rest, std::span<const Triangle> faces,
         std::span<const Index> rank)
      : blocks(face_blocks(rest, faces, rank)), force(rank.size()), beyond(blocks.beyond.size()) {}

  LocalStep step(const UvMap& uv, const Rigidity& rigidity) {
    return {blocks, uv, rigidity, force, beyond};
  }
};

const std::vector<Rigidity> kRigidities{{}, {0.4, false}, {0.01, true}};

TEST(LocalStep, ForceIsMinusTheGradientOfTheEnergy) {  // Eq. (4), by finite differences
  const TriMesh mesh = shapes::random_disk(4, 6);
  UvMap uv;
  for (const Vec3& p : mesh.positions) uv.emplace_back(1.2 * p.x() + 0.3 * p.y(), p.y() - p.z());
  SerialExecutor serial;
  for (const Rigidity& rigidity : kRigidities) {
    Fitted fitted(measure::flatten(mesh), mesh.faces, shapes::as_listed(uv.size()));
    const auto energy_of = [&](const UvMap& map) {
      return fitted.step(map, rigidity).run(serial).energy;
    };
    energy_of(uv);
    const std::vector<Vec2> force = fitted.force;
    for (std::size_t v = 0; v < uv.size(); v += 3)
      for (int k : {0, 1}) {
        UvMap up = uv, down = uv;
        up[v][k] += 1e-6, down[v][k] -= 1e-6;
        EXPECT_NEAR(force[v][k], -(energy_of(up) - energy_of(down)) / 2e-6, 1e-7);
      }
  }
}

UvMap folded_map(const TriMesh& mesh) {
  UvMap uv;
  for (const Vec3& p : mesh.positions) uv.emplace_back(p.x() * p.x(), p.y() - 2 * p.z() * p.x());
  return uv;
}

/// Folded over, and one face collapsed to a point.
UvMap collapsed_map(const TriMesh& mesh) {
  UvMap uv = folded_map(mesh);
  for (Index v : mesh.faces[5]) uv[std::size_t(v)] = Vec2(0.3, 0.2);
  return uv;
}

struct Expected {
  double energy = 0, area = 0;
};

/// Face by face.
Expected expected_sums(std::span<const measure::RestTriangle> rest, std::span<const Triangle> faces,
                       const UvMap& uv, const Rigidity& rigidity) {
  Expected sums;
  for (std::size_t t = 0; t < rest.size(); ++t) {
    const measure::Jacobian j = measure::jacobian(rest[t], measure::uv_edges(faces[t], uv));
    const double lambda = rigidity.at(rest[t].area);
    sums.energy += fit_energy(j, fit_similarity(j, lambda), rest[t].area, lambda);
    sums.area += rest[t].area * std::abs(j.determinant());
  }
  return sums;
}

TEST(LocalStep, AddsUpTheFitsOfAllFacesWhateverTheirNumber) {  // groups are filled up
  const TriMesh disk = shapes::random_disk(4, 6);
  const std::vector<measure::RestTriangle> all = measure::flatten(disk);
  const UvMap uv = collapsed_map(disk);
  SerialExecutor serial;
  for (std::size_t count = 6; count < 12; ++count)
    for (const Rigidity& rigidity : kRigidities) {
      const std::span rest = std::span(all).first(count);
      const std::span faces = std::span<const Triangle>(disk.faces).first(count);
      const Expected expected = expected_sums(rest, faces, uv, rigidity);
      Fitted fitted(rest, faces, shapes::as_listed(uv.size()));
      const LocalSums sums = fitted.step(uv, rigidity).run(serial);
      EXPECT_NEAR(sums.energy, expected.energy, 1e-13 * expected.energy);
      EXPECT_NEAR(sums.uv_area, expected.area, 1e-13 * expected.area);
    }
}

/// -2 A (J - L) W^T of every face, [x^1 x^2] W = 1, at its corners.
std::vector<Vec2> expected_forces(const TriMesh& mesh, const UvMap& uv, const Rigidity& rigidity) {
  const std::vector<measure::RestTriangle> rest = measure::flatten(mesh);
  std::vector<Vec2> force(uv.size(), Vec2::Zero());
  for (std::size_t t = 0; t < rest.size(); ++t) {
    Eigen::Matrix2d x, u;
    x << -rest[t].edge[0], rest[t].edge[2];
    const auto at = [&](int i) { return uv[std::size_t(mesh.faces[t][std::size_t(i)])]; };
    u << at(1) - at(0), at(2) - at(0);
    const measure::Jacobian j = measure::jacobian(rest[t], measure::uv_edges(mesh.faces[t], uv));
    const Similarity fit = fit_similarity(j, rigidity.at(rest[t].area));
    Eigen::Matrix2d l;
    l << fit.a, fit.b, -fit.b, fit.a;
    const Eigen::Matrix2d w = x.inverse();
    const Eigen::Matrix2d pull = -2 * rest[t].area * (u * w - l) * w.transpose();
    force[std::size_t(mesh.faces[t][0])] -= pull.rowwise().sum();
    for (int i : {0, 1}) force[std::size_t(mesh.faces[t][std::size_t(i) + 1])] += pull.col(i);
  }
  return force;
}

TEST(LocalStep, GivesTheForcesOfAllFacesWhateverTheOrderOfVertices) {  // several blocks
  const TriMesh mesh = shapes::random_disk(70, 6);
  ASSERT_GT(mesh.vertex_count(), 2 * FaceBlocks::kOwn);
  const std::vector<measure::RestTriangle> rest = measure::flatten(mesh);
  const UvMap uv = folded_map(mesh);
  SerialExecutor serial;
  TwoThreads two;
  for (const Rigidity& rigidity : kRigidities)
    for (const std::vector<Index>& rank :
         {shapes::as_listed(uv.size()), shapes::shuffled_ranks(uv.size(), 5)}) {
      const UvMap sorted = by_rank(uv, rank);
      Fitted fitted(rest, mesh.faces, rank), again(rest, mesh.faces, rank);
      const LocalSums sums = fitted.step(sorted, rigidity).run(serial);
      const Expected expected = expected_sums(rest, mesh.faces, uv, rigidity);
      EXPECT_NEAR(sums.energy, expected.energy, 1e-12 * expected.energy);
      EXPECT_NEAR(sums.uv_area, expected.area, 1e-12 * expected.area);
      const std::vector<Vec2> force = by_vertex(fitted.force, rank);
      const std::vector<Vec2> known = expected_forces(mesh, uv, rigidity);
      for (std::size_t v = 0; v < uv.size(); ++v)
        EXPECT_LT((force[v] - known[v]).norm(), 1e-11 * (1 + known[v].norm()));
      EXPECT_EQ(again.step(sorted, rigidity).run(two).energy, sums.energy);
      EXPECT_EQ(again.force, fitted.force);
    }
}

TEST(LocalStep, GivesTheSameBitsOnTheBaseline) {
  const TriMesh mesh = shapes::random_disk(60, 7);
  const UvMap uv = collapsed_map(mesh);
  const std::vector<measure::RestTriangle> rest = measure::flatten(mesh);
  const std::vector<Index> rank = shapes::shuffled_ranks(uv.size(), 8);
  SerialExecutor serial;
  for (const Rigidity& rigidity : kRigidities) {
    Fitted wide(rest, mesh.faces, rank), narrow(rest, mesh.faces, rank);
    const LocalSums a = wide.step(uv, rigidity).run(serial);
    const LocalSums b = narrow.step(uv, rigidity).run_on_baseline(serial);
    EXPECT_EQ(a.energy, b.energy);
    EXPECT_EQ(a.uv_area, b.uv_area);
    EXPECT_EQ(wide.force, narrow.force);
  }
}

}  // namespace
}  // namespace unwrapd::solve::arap
