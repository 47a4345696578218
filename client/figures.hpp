#pragma once
// The figures of a report that people are told.

#include <optional>
#include <string>
#include <vector>

#include "api/json.hpp"

namespace unwrapd::client {

struct Figures {
  long faces = 0;
  std::size_t charts = 0;
  double angle = 2, area = 2;  ///< D_angle, D_area
  long flipped = 0;
  double seam_ratio = 0;         ///< length of the seams by the square root of the area
  std::optional<long> overlaps;  ///< none: they were not counted
  double fill = 0;
  std::vector<std::string> notes;  ///< "note (code): text"
};

/// The number, or "?" where they were not counted.
std::string overlaps_of(const Figures& figures);

/// Throws Failure{unreachable} for a text that is no report of this version.
Figures read_figures(const std::string& report);

}  // namespace unwrapd::client
