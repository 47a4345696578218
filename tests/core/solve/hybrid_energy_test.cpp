#include "core/solve/hybrid_energy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/measure/distortion.hpp"
#include "core/measure/energy.hpp"
#include "core/solve/solve.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::solve {
namespace {

struct Sample {
  TriMesh mesh = shapes::random_disk(8, 3);
  std::vector<measure::RestTriangle> rest = measure::flatten(mesh);
  UvMap uv;
  double area = 0;  // of the surface, and of uv

  Sample() {
    std::mt19937 rng(4);
    std::normal_distribution<double> bump(0, 0.05);
    for (const Vec3& p : mesh.positions) uv.push_back({p.x() + bump(rng), p.y() + bump(rng)});
    for (const measure::RestTriangle& triangle : rest) area += triangle.area;
    const double by = std::sqrt(area / measure::uv_area(rest, mesh.faces, uv));
    for (Vec2& u : uv) u *= by;
  }

  [[nodiscard]] std::vector<double> energies(const std::vector<double>& lambdas,
                                             double scale = 1) const {
    UvMap scaled = uv;
    for (Vec2& u : scaled) u *= scale;
    SerialExecutor serial;
    return hybrid_energies({rest, mesh.faces, scaled}, lambdas, LambdaUnits::dimensionless, serial);
  }
};

TEST(HybridEnergy, IsThatOfAsapAndOfArapAtTheEnds) {  // Sec. 5
  const Sample sample;
  const auto energies = sample.energies({0, std::numeric_limits<double>::infinity()});
  const std::span<const measure::RestTriangle> rest = sample.rest;
  EXPECT_NEAR(energies[0], measure::asap_energy(rest, sample.mesh.faces, sample.uv) / sample.area,
              1e-12);
  EXPECT_NEAR(energies[1], measure::arap_energy(rest, sample.mesh.faces, sample.uv) / sample.area,
              1e-12);
}

TEST(HybridEnergy, DoesNotDependOnTheScaleOfTheMap) {
  const Sample sample;
  const std::vector<double> lambdas{0.01, 0.3, 10};
  const auto energies = sample.energies(lambdas), of_large = sample.energies(lambdas, 1000);
  for (std::size_t k = 0; k < lambdas.size(); ++k)
    EXPECT_NEAR(energies[k], of_large[k], 1e-9 * energies[k]);
}

TEST(HybridEnergy, RisesWithLambda) {
  const auto energies = Sample().energies({0, 0.1, 1, 10, 100});
  for (std::size_t k = 1; k < energies.size(); ++k) EXPECT_GT(energies[k], energies[k - 1]);
}

}  // namespace
}  // namespace unwrapd::solve
