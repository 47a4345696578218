#pragma once
// All targets, and how one input is run.

#include <string_view>
#include <vector>

#include "tests/fuzz/targets.hpp"

namespace unwrapd::fuzz {

std::vector<Target> all_targets();

/// An Error is an answer, unless it says that the server is at fault.
void run_one(const Target& target, std::string_view bytes);

}  // namespace unwrapd::fuzz
