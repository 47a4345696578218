// Projected Newton on the energies of barrier.hpp plus the barrier between boundaries. A contact is
// one more triangle of the matrix, so that two sides that press on each other move as one: with its
// curvature on the diagonal alone, steps are several times as many. The pattern has room for
// contacts that are only near: it is analysed anew where others act. Far from the least energy
// Newton's steps are short (plane_holes starts at 2e8 and falls by 5 % in one): there the proxy of
// SLIM (Rabinovich et al. 2017) takes its place.
#include "core/solve/repair/descend_apart.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/cancel.hpp"
#include "core/linear/pair_system.hpp"
#include "core/solve/base/cached.hpp"
#include "core/solve/methods/symmetric_dirichlet.hpp"
#include "core/solve/repair/boundary_barrier.hpp"
#include "core/solve/repair/injective_step.hpp"

namespace unwrapd::solve::repair {
namespace {

constexpr std::size_t kWindow = 3;
constexpr double kAhead = 2;      // reaches, within which a contact has room in the pattern
constexpr double kFarAbove = 10;  // of the energy's mean over the surface
constexpr double kShift = 1e-10;  // of the mean of a face's diagonal: turns cost nothing

linear::PairElement shift_diagonal(const BarrierElement& e) {
  linear::PairElement element{};
  const double shift = kShift * e.hessian.trace() / 6;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k <= i; ++k)
      element[i][k] = e.hessian(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) +
                      (i == k ? shift : 0);
  return element;
}

/// The matrix of a mesh and of its contacts.
class ContactSystem {
 public:
  ContactSystem(const Disk& disk, const BarrierMesh& mesh) : disk_(disk), mesh_(mesh) {}

  /// Makes room in the pattern for the contacts that are near.
  void prepare(const std::vector<Contact>& near, std::span<const Contact> acting) {
    const auto has_room = [&](const Contact& contact) {
      return std::binary_search(contact_.begin(), contact_.end(), vertices_of(contact));
    };
    if (system_ && std::all_of(acting.begin(), acting.end(), has_room)) {
      system_->clear();
      return;
    }
    contact_.clear();
    for (const Contact& contact : near) contact_.push_back(vertices_of(contact));
    std::sort(contact_.begin(), contact_.end());
    std::vector<Triangle> faces = mesh_.faces;
    faces.insert(faces.end(), contact_.begin(), contact_.end());
    system_.emplace(faces, mesh_.free, mesh_.stop);
    check_memory(disk_, system_->bytes());
  }

  void add(std::size_t face, const linear::PairElement& element) { system_->add(face, element); }

  void add(const Contact& contact, const UvMap& uv) {
    const auto at = std::lower_bound(contact_.begin(), contact_.end(), vertices_of(contact));
    system_->add(mesh_.faces.size() + static_cast<std::size_t>(at - contact_.begin()),
                 contact_curvature(contact, uv));
  }

  /// Adds to the diagonal at the vertex of half-edge h.
  void add_at(std::size_t h, double weight) {
    linear::PairElement element{};
    const std::size_t i = 2 * (h % 3);
    element[i][i] = element[i + 1][i + 1] = weight;
    system_->add(h / 3, element);
  }

  /// The Newton step, one a vertex; empty if the matrix is not positive definite.
  std::optional<std::vector<Vec2>> step(const std::vector<Vec2>& gradient) {
    if (!system_->factor()) return std::nullopt;
    std::vector<Vec2> x(static_cast<std::size_t>(mesh_.free.count));
    for_each_free([&](std::size_t v, std::size_t slot) { x[slot] = -gradient[v]; });
    system_->solve(x);
    std::vector<Vec2> step(gradient.size(), Vec2::Zero());
    for_each_free([&](std::size_t v, std::size_t slot) { step[v] = x[slot]; });
    return step;
  }

 private:
  template <class Visit>
  void for_each_free(Visit visit) const {
    for (std::size_t v = 0; v < mesh_.free.slot.size(); ++v)
      if (mesh_.free.slot[v] != linear::kFixed)
        visit(v, static_cast<std::size_t>(mesh_.free.slot[v]));
  }

  const Disk& disk_;
  const BarrierMesh& mesh_;
  std::vector<Triangle> contact_;  ///< that the pattern has room for, ascending
  std::optional<linear::PairSystem> system_;
};

class Descending {
 public:
  Descending(const Disk& disk, const BarrierMesh& mesh, UvMap& uv)
      : disk_(disk), mesh_(mesh), boundary_(disk), system_(disk, mesh), uv_(uv) {
    double rest = 0, share = 0;
    for (std::size_t t = 0; t < mesh.rest.size(); ++t) {
      rest += mesh.rest[t].area;
      share += mesh.share.empty() ? mesh.rest[t].area : mesh.share[t];
    }
    share_ = share / rest;
    weight_ = share;
  }

  void descend(const ApartStage& stage) {
    stage_ = &stage;
    std::vector<double> energy{energy_of(uv_)};
    const auto has_settled = [&] {
      return energy.size() > kWindow &&
             energy[energy.size() - 1 - kWindow] - energy.back() <= stage.tolerance * energy.back();
    };
    for (int k = 0; k < stage.most_steps && !has_settled(); ++k) {
      throw_if_cancelled(mesh_.stop);
      const std::optional<double> after = step(energy.back() > kFarAbove * weight_);
      if (!after) return;
      energy.push_back(*after);
    }
  }

 private:
  /// The energy after the step; empty if no step lowers it.
  std::optional<double> step(bool is_far) {
    const std::vector<Vec2> gradient = fill_model(is_far && stage_->may_use_proxy);
    const std::optional<std::vector<Vec2>> step = system_.step(gradient);
    if (!step) return std::nullopt;
    double slope = 0;
    for (std::size_t v = 0; v < uv_.size(); ++v) slope += gradient[v].dot((*step)[v]);
    const auto energy = [this](const UvMap& uv) { return energy_of(uv); };
    return injective_step(disk_, *step, slope, energy, uv_);
  }

  /// Fills the matrix, with SLIM's proxy if the energy is far from its least. Returns the gradient,
  /// which is valid at free vertices.
  std::vector<Vec2> fill_model(bool is_far) {
    const std::vector<Contact> acting = contacts(uv_, 1);
    system_.prepare(contacts(uv_, kAhead), acting);
    std::vector<Vec2> gradient(uv_.size(), Vec2::Zero());
    for (std::size_t t = 0; t < mesh_.faces.size(); ++t) {
      const BarrierElement e = barrier_element(mesh_, t, uv_, stage_->barrier);
      if (is_far)
        system_.add(t,
                    methods::proxy_element(
                        disk_.rest[t],
                        measure::jacobian(disk_.rest[t], measure::uv_edges(disk_.faces[t], uv_))));
      else
        system_.add(t, shift_diagonal(e));
      for (std::size_t i = 0; i < 3; ++i)
        gradient[static_cast<std::size_t>(mesh_.faces[t][i])] +=
            e.gradient.segment<2>(2 * static_cast<Eigen::Index>(i));
    }
    add_contact_gradient(acting, uv_, gradient);
    for (const Contact& contact : acting) system_.add(contact, uv_);
    add_soft_constraints(gradient);
    return gradient;
  }

  void add_soft_constraints(std::vector<Vec2>& gradient) {
    for (const SoftConstraint& soft_constraint : mesh_.soft) {
      const auto v = static_cast<std::size_t>(soft_constraint.vertex);
      gradient[v] += 2 * soft_constraint.weight * (uv_[v] - soft_constraint.at);
      const auto corner = static_cast<std::size_t>(disk_.corners.corner[disk_.corners.begin[v]]);
      system_.add_at(corner, 2 * soft_constraint.weight);
    }
  }

  [[nodiscard]] double energy_of(const UvMap& uv) const {
    const double own = barrier_energy(mesh_, uv, stage_->barrier);
    return std::isfinite(own) ? own + contact_energy(contacts(uv, 1), uv) : own;
  }

  [[nodiscard]] std::vector<Contact> contacts(const UvMap& uv, double ahead) const {
    std::vector<Contact> contacts = boundary_.contacts(uv, ahead);
    for (Contact& contact : contacts) contact.weight *= stage_->contact * share_;
    return contacts;
  }

  const Disk& disk_;
  const BarrierMesh& mesh_;
  BoundaryBarrier boundary_;
  ContactSystem system_;
  UvMap& uv_;
  double weight_ = 1;  ///< of all faces in the energy
  double share_ = 1;   ///< of a face in the energy, in its rest area
  const ApartStage* stage_ = nullptr;
};

}  // namespace

void descend_apart(const Disk& disk, const BarrierMesh& mesh, std::span<const ApartStage> stages,
                   UvMap& uv) {
  Descending descending(disk, mesh, uv);
  for (const ApartStage& stage : stages) descending.descend(stage);
}

}  // namespace unwrapd::solve::repair
