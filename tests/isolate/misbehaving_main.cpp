// unwrapd whose work on meshes does what a bug, or a stranger who has found one, would do: the
// first line of an OBJ says which, "# do WHAT" while it is unwrapped, "# draw WHAT" when somebody
// asks for a picture or for another format.
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "server/program.hpp"

namespace {

using unwrapd::Error;
using unwrapd::ErrorCode;
namespace server = unwrapd::server;

void eat_memory() {
  std::vector<std::string> eaten;
  while (true) eaten.emplace_back(std::size_t{64} << 20, 'x');
}

[[noreturn]] void tell(bool is_open) {
  throw Error(ErrorCode::solver_failed, is_open ? "It is open." : "It is closed.");
}

using Deed = std::function<void(server::JobOutput&)>;

const std::map<std::string, Deed> kDeeds = {
    {"segv", [](auto&) { std::raise(SIGSEGV); }},
    {"abort", [](auto&) { std::abort(); }},
    {"leave", [](auto&) { std::_Exit(3); }},
    {"memory", [](auto&) { eat_memory(); }},
    {"hang",
     [](auto&) {
       while (true) ::usleep(1000);
     }},
    {"connect", [](auto&) { ::socket(AF_INET, SOCK_STREAM, 0); }},
    {"fork", [](auto&) { ::fork(); }},
    {"exec", [](auto&) { ::execl("/bin/true", "true", nullptr); }},
    {"open", [](auto&) { tell(::open("/etc/hostname", O_RDONLY) >= 0); }},
    {"inherit", [](auto&) { tell(::lseek(3, 0, SEEK_CUR) >= 0 || errno != EBADF); }},
    {"environment", [](auto&) { tell(::getenv("PATH") != nullptr); }},
    {"chatter", [](auto&) { static_cast<void>(::write(STDIN_FILENO, "no frame of ours", 16)); }},
    {"traverse", [](auto& output) { output.file("../../escaped", "x"); }},
    {"overwrite", [](auto& output) { output.file("document", "x"); }},
};

void misbehave(std::string_view when, const unwrapd::asset::Input& input,
               server::JobOutput& output) {
  for (const auto& [name, deed] : kDeeds)
    if (input.document.starts_with("# " + std::string(when) + " " + name + "\n")) deed(output);
}

std::string run(const server::JobTask& task, const unwrapd::asset::Input& input,
                server::JobOutput& output, const unwrapd::api::Limits& limits,
                unwrapd::Executor& executor) {
  misbehave("do", input, output);
  return server::run_job(task, input, output, limits, executor);
}

class NoOutput final : public server::JobOutput {
 public:
  void stage(const unwrapd::StageEvent& /*event*/) override {}
  void iteration(const unwrapd::IterationEvent& /*event*/, double /*elapsed_ms*/) override {}
  void result(std::string_view /*format*/, std::string_view /*bytes*/) override {}
  void file(std::string_view /*name*/, std::string_view /*bytes*/) override {}
};

std::string draw(const server::Rendering& rendering, const server::RenderingInput& input,
                 const unwrapd::api::Limits& limits) {
  NoOutput none;
  misbehave("draw", input.asset, none);
  return server::render(rendering, input, limits);
}

}  // namespace

// With NO_WORKER in its environment it is as on a machine where no worker process can be had.
int main(int argc, char** argv) {
  const bool alone = ::getenv("NO_WORKER") != nullptr;
  return server::run_program(argc, argv,
                             {.run = run, .draw = draw, .program = alone ? "/bin/false" : ""});
}
