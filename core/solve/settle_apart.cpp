// Projected Newton on the energy that untangling settles by (barrier.hpp), plus the barrier between
// boundaries with the same weight. Contacts add to the diagonal blocks alone, so that one analysis
// of the pattern serves all steps.
//
// Ending with the symmetric Dirichlet energy instead would cost a conformal map its angles.
#include "core/solve/settle_apart.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "core/cancel.hpp"
#include "core/linear/engine.hpp"
#include "core/solve/barrier.hpp"
#include "core/solve/boundary_barrier.hpp"
#include "core/solve/injective_step.hpp"

namespace unwrapd {
namespace {

constexpr std::array<double, 3> kFading = {1e-1, 1e-2, 1e-3};  // weights of the barriers
constexpr int kMostSteps = 30;                                 // for each weight
constexpr double kTolerance = 1e-3;                            // relative fall in one step
constexpr double kShift = 1e-10;  // of the mean of the diagonal: translations and turns are free

BarrierMesh loose(const Disk& disk, const std::vector<Spring>& springs,
                  const std::stop_token& stop) {
  const std::vector<char> fixed(disk.positions.size(), 0);
  return {{disk.faces.begin(), disk.faces.end()},
          {disk.rest.begin(), disk.rest.end()},
          number_free(fixed),
          springs,
          stop};
}

class Settling {
 public:
  Settling(const Disk& disk, const MapIntent& intent, UvMap& uv)
      : disk_(disk),
        mesh_(loose(disk, intent.springs, intent.stop)),
        boundary_(disk),
        barrier_{intent.rigidity, 1, 0},
        model_(barrier_pattern(mesh_)),
        stop_(intent.stop),
        analysis_(analyse(model_.hessian, stop_)),
        uv_(uv) {}

  /// Returns the share by which the energy fell.
  double step(double weight) {
    barrier_.weight = weight;
    fill_barrier_model(mesh_, uv_, barrier_, model_);
    add_contacts();
    SerialExecutor serial;
    JobExecutor job(serial, stop_);
    const std::unique_ptr<RealSystem> system = try_factor(analysis_, model_.hessian, job);
    if (system == nullptr) return 0;
    std::vector<Vec2> x;  // one entry an unknown, in its first coordinate
    for (const double g : model_.gradient) x.emplace_back(-g, 0);
    system->solve(x, stop_);
    std::vector<Vec2> step;
    for (std::size_t k = 0; k < x.size(); k += 2) step.emplace_back(x[k].x(), x[k + 1].x());
    double slope = 0;
    for (std::size_t k = 0; k < x.size(); ++k)
      slope += model_.gradient[static_cast<Index>(k)] * x[k].x();
    const double before = energy_of(uv_);
    const auto energy = [this](const UvMap& uv) { return energy_of(uv); };
    const std::optional<double> after = injective_step(disk_, step, slope, energy, uv_);
    return after ? (before - *after) / before : 0;
  }

 private:
  [[nodiscard]] double energy_of(const UvMap& uv) const {
    const double own = barrier_energy(mesh_, uv, barrier_);
    return std::isfinite(own) ? own + contact_energy(contacts(uv), uv) : own;
  }

  [[nodiscard]] std::vector<Contact> contacts(const UvMap& uv) const {
    std::vector<Contact> contacts = boundary_.contacts(uv);
    for (Contact& contact : contacts) contact.weight *= barrier_.weight;
    return contacts;
  }

  void add_contacts() {
    const std::vector<Contact> near = contacts(uv_);
    std::vector<Vec2> gradient(uv_.size(), Vec2::Zero());
    std::vector<Vec3> blocks(uv_.size(), Vec3::Zero());
    add_contact_gradient(near, uv_, gradient);
    add_contact_curvature(near, uv_, blocks);
    SparseMatrix& hessian = model_.hessian;
    const double shift = kShift * hessian.diagonal().mean();
    for (std::size_t v = 0; v < uv_.size(); ++v) {
      const auto x = static_cast<Eigen::Index>(2 * v), y = x + 1;
      model_.gradient.segment<2>(x) += gradient[v];
      hessian.coeffRef(x, x) += blocks[v][0] + shift;
      hessian.coeffRef(y, x) += blocks[v][1];
      hessian.coeffRef(y, y) += blocks[v][2] + shift;
    }
  }

  const Disk& disk_;
  BarrierMesh mesh_;
  BoundaryBarrier boundary_;
  Barrier barrier_;
  Quadratic model_;
  std::stop_token stop_;
  std::shared_ptr<const Analysis> analysis_;
  UvMap& uv_;
};

}  // namespace

void settle_apart(const Disk& disk, const MapIntent& intent, UvMap& uv) {
  Settling settling(disk, intent, uv);
  for (const double weight : kFading) {
    double fall = 1;
    for (int k = 0; k < kMostSteps && fall >= kTolerance; ++k) {
      throw_if_cancelled(intent.stop);
      fall = settling.step(weight);
    }
  }
}

}  // namespace unwrapd
