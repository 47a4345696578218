#include "core/solve/repair/profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace unwrapd::solve::repair {
namespace {

using ProfileOf = std::function<Profile(double, double)>;

struct Named {
  const char* name;
  ProfileOf at;
};

const Named kProfiles[] = {
    {"arap",
     [](double q, double r) { return fit_profile(q, r, std::numeric_limits<double>::infinity()); }},
    {"hybrid", [](double q, double r) { return fit_profile(q, r, 0.3); }},
    {"symmetric Dirichlet", symmetric_dirichlet_profile},
    {"mips", mips_profile},
    {"wall", [](double q, double r) { return wall_profile(q, r, 0); }},
    {"steep wall", [](double q, double r) { return fourth_power(wall_profile(q, r, 0)); }},
};

TEST(Profile, HasTheDerivativesOfItsDifferences) {
  constexpr double h = 1e-6;
  for (const auto& [name, at] : kProfiles)
    for (double q : {0.7, 1.0, 1.6})
      for (double r : {0.05, 0.3, 0.6}) {
        SCOPED_TRACE(name + (" " + std::to_string(q)) + " " + std::to_string(r));
        const Profile p = at(q, r);
        const Profile q0 = at(q - h, r), q1 = at(q + h, r), r0 = at(q, r - h), r1 = at(q, r + h);
        const auto expect_near = [](double derivative, double difference) {
          EXPECT_NEAR(derivative, difference / (2 * h), 1e-6 * (1 + std::abs(derivative)));
        };
        expect_near(p.q, q1.value - q0.value);
        expect_near(p.r, r1.value - r0.value);
        expect_near(p.qq, q1.q - q0.q);
        expect_near(p.qr, q1.r - q0.r);
        expect_near(p.qr, r1.q - r0.q);
        expect_near(p.rr, r1.r - r0.r);
      }
}

TEST(Profile, IsWhatItsSingularValuesSay) {
  for (double a : {0.4, 1.0, 2.5})
    for (double b : {0.2, 0.4}) {
      const double q = (a + b) / 2, r = std::abs(a - b) / 2;
      EXPECT_NEAR(symmetric_dirichlet_profile(q, r).value,
                  a * a + b * b + 1 / (a * a) + 1 / (b * b) - 4, 1e-12 / (b * b * b));
      EXPECT_NEAR(mips_profile(q, r).value, a / b + b / a - 2, 1e-12);
    }
}

TEST(Profile, IsNothingForRotations) {
  for (const auto& [name, at] : kProfiles) EXPECT_EQ(at(1, 0).value, 0) << name;
}

}  // namespace
}  // namespace unwrapd::solve::repair
