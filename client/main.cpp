#include <sys/ioctl.h>
#include <unistd.h>

#include <csignal>
#include <iostream>

#include "client/interrupt.hpp"
#include "client/printable.hpp"
#include "client/run.hpp"

namespace {

using namespace unwrapd::client;

constexpr std::size_t kDefaultWidth = 80;

ProgressStyle style_for(const Arguments& arguments) {
  if (arguments.quiet) return ProgressStyle::none;
  return isatty(STDERR_FILENO) != 0 ? ProgressStyle::bar : ProgressStyle::lines;
}

/// One column less than the terminal has, since a full line makes some terminals wrap.
std::size_t terminal_width() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return (known ? size.ws_col : kDefaultWidth) - 1;
}

ExitCode perform(const Arguments& arguments) {
  Interrupt interrupt(arguments.timeout);
  try {
    run(arguments, {std::cout, std::cerr, style_for(arguments), terminal_width()},
        interrupt.token());
    return ExitCode::ok;
  } catch (const Failure& failure) {
    const bool timed_out = failure.code() == ExitCode::interrupted && interrupt.timed_out();
    std::cerr << "unwrap: " << (timed_out ? "No result within --timeout. " : "")
              << printable(failure.what()) << std::endl;
    return timed_out ? ExitCode::unreachable : failure.code();
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(
      SIGPIPE,
      SIG_IGN);  // a server that closes the connection is an error, not the end of this process
  const auto parsed = parse_arguments(argc, argv);
  if (const auto* message = std::get_if<Message>(&parsed)) {
    (message->code == ExitCode::ok ? std::cout : std::cerr) << message->text << std::flush;
    return static_cast<int>(message->code);
  }
  return static_cast<int>(perform(std::get<Arguments>(parsed)));
}
