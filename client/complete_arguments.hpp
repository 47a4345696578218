#pragma once
// What the parser of the command line cannot check, and what follows from its flags.

#include <string>

#include "client/arguments.hpp"

namespace unwrapd::client {

constexpr const char* kUsualServer = "http://127.0.0.1:8080";

/// The raw values of the command line's flags.
struct RawArguments {
  Arguments arguments;
  std::string server;
  bool local = false;
  double timeout_seconds = 0;
};

/// Checks the values together, and derives the remaining ones. Throws Failure.
Arguments complete_arguments(RawArguments raw);

}  // namespace unwrapd::client
