#include "core/linear/engine.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>

#include "core/measure/energy.hpp"
#include "core/solve/arap/objective.hpp"
#include "core/solve/maps/conformal_system.hpp"
#include "core/solve/maps/convex_map.hpp"
#include "tests/core/linear/systems.hpp"
#include "tests/core/obj_reader.hpp"
#include "tests/core/solve/disk_of.hpp"
#include "tests/core/solve/ranks.hpp"

namespace unwrapd::linear {
namespace {

/// The engine that ours is compared with.
class Reference final : public RealSystem {
 public:
  explicit Reference(const SparseMatrix& lower) : llt_(lower) {}
  [[nodiscard]] bool is_definite() const { return llt_.info() == Eigen::Success; }
  void solve(std::span<Vec2> b, const std::stop_token& = {}) const override {
    Eigen::Map<Eigen::Matrix2Xd> x(b.front().data(), 2, Eigen::Index(b.size()));
    x = llt_.solve(x.transpose()).transpose().eval();
  }

 private:
  Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower> llt_;
};

std::unique_ptr<RealSystem> ours(const SparseMatrix& lower) {
  return try_factor(analyse(lower), lower);
}

template <typename Visit>
void for_each_disk_of_the_data(Visit visit) {
  for (const char* folder : {"disk", "paper"})
    for (const auto& entry : std::filesystem::directory_iterator(test_data() / folder)) {
      if (entry.path().extension() != ".obj") continue;
      SCOPED_TRACE(entry.path().filename());
      const charts::Charts charts =
          charts::make_charts(shapes::surface_of(read_obj(entry.path())), SeamMode::keep);
      for (const charts::Chart& chart : charts.charts)
        visit(solve::make_disk(chart.mesh, chart.loops));
    }
}

std::vector<TriMesh> odd_disks() {
  const auto flat = [](double r, double phi) {
    return Vec3(r * std::cos(phi), r * std::sin(phi), r * r);
  };
  return {shapes::grid(1, 1),
          shapes::grid(200, 1),
          shapes::random_disk(40, 3),
          shapes::shuffled(shapes::random_disk(60, 4), 5),
          shapes::annulus(70, 9),
          shapes::polar_disk(3000, 1, shapes::kTurn, flat),  // one vertex with 3000 neighbours
          shapes::polar_disk(700, 4, shapes::kTurn, flat)};
}

TEST(Engine, SolvesLikeTheReference) {
  for (const TriMesh& mesh : odd_disks()) {
    const shapes::OwnedDisk owned = shapes::disk_of(mesh);
    const SparseMatrix lower = arap_matrix(owned.disk);
    const std::vector<Vec2> b = random_forces(lower, 1);
    const std::vector<Vec2> expected = solution(Reference(lower), b);
    const std::vector<Vec2> x = solution(*ours(lower), b);
    EXPECT_LT(gap(x, expected), 1e-9 * norm(expected)) << mesh.vertex_count();
    EXPECT_LT(backward_error(lower, x, b), 1e-14);
  }
}

TEST(Engine, SolvesLikeTheReferenceOnAllData) {
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  for_each_disk_of_the_data([](const solve::Disk& disk) {
    const SparseMatrix lower = arap_matrix(disk);
    const std::vector<Vec2> b = random_forces(lower, 2);
    const auto system = ours(lower);
    ASSERT_NE(system, nullptr);
    const std::vector<Vec2> x = solution(*system, b);
    EXPECT_LT(backward_error(lower, x, b), 1e-13);
    EXPECT_LT(backward_error(lower, x, b),
              1e-15 + 20 * backward_error(lower, solution(Reference(lower), b), b));
  });
}

double energy_after_ten_iterations(const solve::Disk& disk, const RealSystem& system) {
  SerialExecutor serial;
  const solve::VertexConstraints nothing;
  UvMap uv = solve::maps::tutte_map(disk);
  solve::arap::Objective objective(disk, solve::arap::Rigidity{}, nothing,
                                   shapes::as_listed(uv.size()), serial);
  std::vector<Vec2> force(uv.size());
  for (int k = 0; k < 10; ++k) {
    objective.evaluate(uv, force);
    system.solve(force);
    for (std::size_t v = 0; v < uv.size(); ++v) uv[v] += force[v];
  }
  return objective.evaluate(uv, force);
}

TEST(Engine, GivesTheReferencesEnergyOnAllData) {
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  for_each_disk_of_the_data([](const solve::Disk& disk) {
    const SparseMatrix lower = arap_matrix(disk);
    const double expected = energy_after_ten_iterations(disk, Reference(lower));
    EXPECT_NEAR(energy_after_ten_iterations(disk, *ours(lower)), expected, 1e-7 * expected + 1e-12);
  });
}

/// A bumpy disk in which every fourth corner is pulled to within `height` of the side opposite.
TriMesh with_caps(double height) {
  TriMesh mesh = shapes::random_disk(24, 6);
  const std::size_t count = mesh.faces.size();
  for (std::size_t t = 0; t < count; t += 4) {  // a new vertex near the middle of a side
    const auto [a, b, c] = mesh.faces[t];
    const auto at = [&](Index v) { return mesh.positions[std::size_t(v)]; };
    const Index m = mesh.vertex_count();
    mesh.positions.push_back((1 - height) * (at(a) + at(b)) / 2 + height * at(c));
    mesh.faces[t] = {a, m, c};
    mesh.faces.push_back({m, b, c});
    mesh.faces.push_back({a, b, m});
  }
  return mesh;
}

TEST(Engine, HoldsOutOnCapsAndNeedles) {
  for (double height : {1e-3, 1e-6, 1e-9}) {
    const shapes::OwnedDisk owned = shapes::disk_of(with_caps(height));
    const SparseMatrix lower = arap_matrix(owned.disk);
    ASSERT_TRUE(Reference(lower).is_definite()) << height;
    const auto system = ours(lower);
    ASSERT_NE(system, nullptr) << height;
    const std::vector<Vec2> b = random_forces(lower, 3);
    EXPECT_LT(backward_error(lower, solution(*system, b), b), 1e-13) << height;
    const double expected = energy_after_ten_iterations(owned.disk, Reference(lower));
    EXPECT_NEAR(energy_after_ten_iterations(owned.disk, *system), expected, 1e-7 * expected)
        << height;
  }
}

/// LSCM's, made definite without pins.
ComplexMatrix conformal_matrix_of(const solve::Disk& disk) {
  ComplexMatrix lower = solve::maps::conformal_matrix(disk);
  for (Index v = 0; v < disk.vertex_count(); ++v) lower.coeffRef(v, v) += 1e-4;
  lower.makeCompressed();
  return lower;
}

/// |H z - b| over |H| |z|.
double backward_error(const ComplexMatrix& lower, const Eigen::VectorXcd& z,
                      const Eigen::VectorXcd& b) {
  return (lower.selfadjointView<Eigen::Lower>() * z - b).norm() / (lower.norm() * z.norm());
}

void expect_hermitian_like_the_reference(const solve::Disk& disk) {
  const ComplexMatrix lower = conformal_matrix_of(disk);
  const Eigen::VectorXcd b = Eigen::VectorXcd::Random(lower.cols());
  std::vector<Complex> x(b.begin(), b.end());
  const auto system = try_factor(lower);
  ASSERT_NE(system, nullptr);
  system->solve(x);
  const Eigen::VectorXcd z = Eigen::VectorXcd::Map(x.data(), lower.cols());
  const Eigen::SimplicialLLT<ComplexMatrix, Eigen::Lower> reference(lower);
  EXPECT_LT(backward_error(lower, z, b), 1e-15 + 20 * backward_error(lower, reference.solve(b), b));
}

TEST(Engine, SolvesHermitianSystemsLikeTheReference) {
  for (const TriMesh& mesh : odd_disks())
    expect_hermitian_like_the_reference(shapes::disk_of(mesh).disk);
  for (double height : {1e-3, 1e-6, 1e-9})
    expect_hermitian_like_the_reference(shapes::disk_of(with_caps(height)).disk);
  if (test_data().empty()) GTEST_SKIP() << "no test data";
  for_each_disk_of_the_data(expect_hermitian_like_the_reference);
}

TEST(Engine, OrdersPairsByVerticesAndSolvesTheSame) {
  for (const TriMesh& mesh : odd_disks()) {
    const shapes::OwnedDisk owned = shapes::disk_of(mesh);
    const SparseMatrix pairs = as_pairs(conformal_matrix_of(owned.disk));
    const std::vector<Vec2> b = random_forces(pairs, 7);
    const std::vector<Vec2> expected = solution(*ours(pairs), b);
    const std::vector<Vec2> x = solution(*try_factor(analyse_pairs(pairs), pairs), b);
    EXPECT_LT(gap(x, expected), 1e-8 * norm(expected)) << mesh.vertex_count();
  }
}

TEST(Engine, RefusesWhatIsNotDefinite) {
  const shapes::OwnedDisk owned = shapes::disk_of(shapes::random_disk(30, 7));
  SparseMatrix lower = arap_matrix(owned.disk);
  const auto analysis = analyse(lower);
  for (double bad : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    SparseMatrix changed = lower;
    changed.coeffRef(300, 300) = bad;
    EXPECT_EQ(try_factor(analysis, changed), nullptr) << bad;
  }
  EXPECT_NE(try_factor(analysis, lower), nullptr);
}

TEST(Engine, SolvesWhatFallsApart) {  // several components, one of them a single vertex
  const TriMesh mesh =
      shapes::merged(std::vector{shapes::random_disk(20, 1), shapes::random_disk(3, 2),
                                 TriMesh{{Vec3(0, 0, 0)}, {}}, shapes::sphere_cap(30, 12)});
  SparseMatrix lower = lower_laplacian(mesh.faces, mesh.vertex_count(),
                                       std::vector<double>(3 * mesh.faces.size(), 0.7));
  for (Index v = 0; v < mesh.vertex_count(); ++v) lower.coeffRef(v, v) += 0.1;
  const std::vector<Vec2> b = random_forces(lower, 6);
  const std::vector<Vec2> expected = solution(Reference(lower), b);
  EXPECT_LT(gap(solution(*ours(lower), b), expected), 1e-12 * norm(expected));
}

}  // namespace
}  // namespace unwrapd::linear
