#pragma once
// The program unwrapd, as a function: tests build programs of their own around it.

#include "server/job_worker.hpp"

namespace unwrapd::server {

/// Reads the command line, serves until SIGTERM or SIGINT, drains. With --job-worker alone it is
/// the worker process of a server instead, and does what run does. Returns the exit code.
int run_program(int argc, char** argv, const JobRunner& run = run_job);

}  // namespace unwrapd::server
