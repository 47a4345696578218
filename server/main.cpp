// unwrapd: reads its command line, serves until SIGTERM, SIGINT or, at a terminal, SIGHUP; then
// drains and exits with 0.
#include "server/program.hpp"

int main(int argc, char** argv) { return unwrapd::server::run_program(argc, argv); }
