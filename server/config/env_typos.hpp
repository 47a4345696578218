#pragma once
// Finds environment variables that are meant for the server and that no option has.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server::config {

/// What is wrong with the first of "NAME=value" (nullptr ends the list) whose name begins with
/// UNWRAPD_, is unknown, and belongs neither to another program of this project nor to a container
/// engine that names a service so. The sentence names the known variable that is spelled most like
/// it.
std::optional<std::string> unknown_variable(const char* const* environment,
                                            const std::vector<std::string>& known);

/// How many letters must be put in, left out, changed or swapped with their neighbour to make one
/// of the other.
std::size_t spelling_distance(std::string_view left, std::string_view right);

}  // namespace unwrapd::server::config
