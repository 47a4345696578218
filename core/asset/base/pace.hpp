#pragma once
// Checks a stop token at regular intervals in work whose steps have unequal cost.

#include <cstddef>
#include <stop_token>
#include <utility>

#include "core/base/cancel.hpp"

namespace unwrapd::asset {

/// Adds up work in units of some 10 to 100 ns, and checks the stop at the start and after a fixed
/// amount. Throws Error{cancelled}.
class Pace {
 public:
  explicit Pace(std::stop_token stop) : stop_(std::move(stop)) { throw_if_cancelled(stop_); }

  void add(std::size_t units) {
    done_ += units;
    if (done_ < kUnits) return;
    done_ = 0;
    throw_if_cancelled(stop_);
  }

 private:
  static constexpr std::size_t kUnits = 65'536;
  std::stop_token stop_;
  std::size_t done_ = 0;
};

}  // namespace unwrapd::asset
