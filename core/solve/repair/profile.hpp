#pragma once
// Energies of one triangle as functions of the two parts of its Jacobian
// (core/measure/jacobian.hpp): Q, of its similarity part, and R, of the remainder. The least value
// of each is 0.

namespace unwrapd::solve::repair {

/// The energy that a method minimizes on a triangle: the fit of Eq. (5), or another one.
enum class OwnEnergy { fit, symmetric_dirichlet, mips };

/// A function of Q and R with its derivatives.
struct Profile {
  double value = 0;
  double q = 0, r = 0;
  double qq = 0, qr = 0, rr = 0;
};

/// Eq. (5): min over r of 2 (Q - r)^2 + lambda (r^2 - 1)^2, plus 2 R^2.
Profile fit_profile(double q, double r, double lambda);

/// |J|^2 + |J^-1|^2 - 4 = 2 (Q^2 + R^2) (1 + d^-2) - 4 with d = Q^2 - R^2 > 0.
Profile symmetric_dirichlet_profile(double q, double r);

/// sigma_max / sigma_min + sigma_min / sigma_max - 2 = 4 R^2 / det J: MIPS (Hormann, Greiner 2000).
/// Any scale will do. Q > R.
Profile mips_profile(double q, double r);

/// (Q^2 + R^2 + (1 + d^2) / 2) / chi(d) - 2 with d = Q^2 - R^2 and
/// chi(d) = (d + sqrt(epsilon^2 + d^2)) / 2: 0 for rotations, without bound as d goes to 0 where
/// epsilon is 0.
Profile wall_profile(double q, double r, double epsilon);

/// p^4, for p >= 0: next to nothing near the least of p, and steep far from it.
Profile fourth_power(const Profile& p);

/// Replaces the second derivatives by the nearest positive semidefinite block.
void project(Profile& p);

}  // namespace unwrapd::solve::repair
