#pragma once
// Finds environment variables that are meant for the server and that no option has.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server::config {

struct UnknownVariable {
  std::string name;
  std::string nearest;  ///< the known one that is spelled most like it
};

/// The first of "NAME=value" (nullptr ends the list) whose name begins with UNWRAPD_, is unknown,
/// and belongs neither to another program of this project nor to a container engine that names a
/// service so.
std::optional<UnknownVariable> unknown_variable(const char* const* environment,
                                                const std::vector<std::string>& known);

/// How many letters must be put in, left out, changed or swapped with their neighbour to make one
/// of the other.
std::size_t spelling_distance(std::string_view left, std::string_view right);

}  // namespace unwrapd::server::config
