#pragma once
// The program unwrapd, as a function: tests build programs of their own around it.

#include "server/work/job_worker.hpp"

namespace unwrapd::server {

/// Reads the command line, serves until SIGTERM or SIGINT, drains. With --job-worker alone it is
/// the worker process of a server instead, which calls these functions; the program that is
/// started for it is this one when they name none. Returns the exit code.
int run_program(int argc, char** argv, work::WorkerFunctions functions = {});

}  // namespace unwrapd::server
