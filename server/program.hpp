#pragma once
// The program unwrapd, as a function: tests build programs of their own around it.

namespace unwrapd::server {

/// Reads the command line, serves until SIGTERM or SIGINT, drains. Returns the exit code.
int run_program(int argc, char** argv);

}  // namespace unwrapd::server
