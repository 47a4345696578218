// The wall is the regularised barrier of Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov,
// "Foldover-Free Maps in 50 Lines of Code", SIGGRAPH 2021.
#include "core/solve/repair/profile.hpp"

#include <algorithm>
#include <cmath>

#include "core/solve/arap/local_step.hpp"

namespace unwrapd::solve::repair {
namespace {

/// chi and its two derivatives.
struct Chi {
  double value, slope, bend;
};

Chi chi_of(double d, double epsilon) {
  const double root = std::sqrt(epsilon * epsilon + d * d);
  const double value = d > 0 ? (d + root) / 2 : epsilon * epsilon / (2 * (root - d));
  if (!(root > 0)) return {0, 1, 0};
  const double share = epsilon / root;
  return {value, (1 + d / root) / 2, share * share / (2 * root)};
}

/// The scale of the similarity that fits (q, 0) best, without a root where it is known.
double fitted_scale(double q, double lambda) {
  if (lambda == 0) return q;
  if (std::isinf(lambda)) return 1;
  return arap::fit_similarity({q, 0, 0, 0}, lambda).a;
}

}  // namespace

Profile fit_profile(double q, double r, double lambda) {
  const measure::Jacobian along{q, 0, r, 0};
  const double scale = fitted_scale(q, lambda);
  const double stiffness = 1 / (1 + 1 / (lambda * (3 * scale * scale - 1)));
  Profile p;
  p.value = arap::fit_energy(along, {scale, 0}, 1, lambda);
  p.q = 4 * (q - scale);
  p.r = 4 * r;
  p.qq = 4 * stiffness;
  p.rr = 4;
  return p;
}

Profile symmetric_dirichlet_profile(double q, double r) {
  const double d = (q - r) * (q + r), n = 2 * (q * q + r * r);
  const double k = 1 / (d * d), slope = -2 * k / d, bend = 6 * k * k;  // of d^-2
  const double k_q = slope * 2 * q, k_r = -slope * 2 * r;
  Profile p;
  p.value = n * (1 + k) - 4;
  p.q = 4 * q * (1 + k) + n * k_q;
  p.r = 4 * r * (1 + k) + n * k_r;
  p.qq = 4 * (1 + k) + 8 * q * k_q + n * (4 * q * q * bend + 2 * slope);
  p.rr = 4 * (1 + k) + 8 * r * k_r + n * (4 * r * r * bend - 2 * slope);
  p.qr = 4 * q * k_r + 4 * r * k_q - n * 4 * q * r * bend;
  return p;
}

Profile mips_profile(double q, double r) {
  const double part = 1 / ((q - r) * (q + r)), both = q * r * part;
  Profile p;
  p.value = 4 * r * r * part;
  p.q = -8 * both * r * part;
  p.r = 8 * both * q * part;
  p.qq = (32 * both * both - 8 * r * r * part) * part;
  p.rr = (32 * both * both + 8 * q * q * part) * part;
  p.qr = -16 * both * (q * q + r * r) * part * part;
  return p;
}

Profile wall_profile(double q, double r, double epsilon) {
  const double d = (q - r) * (q + r);
  const Chi chi = chi_of(d, epsilon);
  const double n = q * q + r * r + (1 + d * d) / 2;
  const double part = 1 / chi.value;
  const double b = n * part;
  Profile p;
  p.value = b - 2;
  const double chi_q = 2 * q * chi.slope, chi_r = -2 * r * chi.slope;
  p.q = (2 * q * (1 + d) - b * chi_q) * part;
  p.r = (2 * r * (1 - d) - b * chi_r) * part;
  const double chi_qq = 4 * q * q * chi.bend + 2 * chi.slope;
  const double chi_rr = 4 * r * r * chi.bend - 2 * chi.slope;
  const double chi_qr = -4 * q * r * chi.bend;
  p.qq = (2 * (1 + d) + 4 * q * q - 2 * p.q * chi_q - b * chi_qq) * part;
  p.rr = (2 * (1 - d) + 4 * r * r - 2 * p.r * chi_r - b * chi_rr) * part;
  p.qr = (-4 * q * r - p.q * chi_r - p.r * chi_q - b * chi_qr) * part;
  return p;
}

Profile fourth_power(const Profile& p) {
  const double square = p.value * p.value;
  const double slope = 4 * square * p.value, bend = 12 * square;
  Profile power;
  power.value = square * square;
  power.q = slope * p.q;
  power.r = slope * p.r;
  power.qq = slope * p.qq + bend * p.q * p.q;
  power.qr = slope * p.qr + bend * p.q * p.r;
  power.rr = slope * p.rr + bend * p.r * p.r;
  return power;
}

void project(Profile& p) {
  const double mean = (p.qq + p.rr) / 2, half = (p.qq - p.rr) / 2;
  const double radius = std::sqrt(half * half + p.qr * p.qr);
  if (mean - radius >= 0) return;
  const double high = std::max(0.0, mean + radius);  // along (radius + half, qr), unnormalised
  const double c = radius > 0 ? half / radius : 1, s = radius > 0 ? p.qr / radius : 0;
  p.qq = high * (1 + c) / 2;
  p.rr = high * (1 - c) / 2;
  p.qr = high * s / 2;
}

}  // namespace unwrapd::solve::repair
