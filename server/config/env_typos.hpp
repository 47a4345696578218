#pragma once
// Which variables of the environment are meant for the server, and are none.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server::config {

struct UnknownVariable {
  std::string name;
  std::string nearest;  ///< the known one that is spelled most like it
};

/// The first of "NAME=value" (a null ends them) whose name begins with UNWRAPD_, is not known, and
/// belongs to nobody else: neither to the other programs of this project nor to a container engine
/// that names a service so.
std::optional<UnknownVariable> unknown_variable(const char* const* environment,
                                                const std::vector<std::string>& known);

/// How many letters must be put in, left out, changed or swapped with their neighbour to make one
/// of the other.
std::size_t spelling_distance(std::string_view left, std::string_view right);

}  // namespace unwrapd::server::config
