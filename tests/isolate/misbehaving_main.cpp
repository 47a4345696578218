// unwrapd whose work on meshes does what a bug, or a stranger who has found one, would do: the
// first line of an OBJ says which, "# do WHAT" while it is unwrapped, "# draw WHAT" when somebody
// asks for a picture or for another format. "# victim PID" in the second line names a process to
// send signals to.
#include <fcntl.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "server/program.hpp"
#include "server/work/job_frames.hpp"

namespace {

using unwrapd::Error;
using unwrapd::ErrorCode;
namespace server = unwrapd::server;

[[noreturn]] void tell(bool is_open) {
  throw Error(ErrorCode::solver_failed, is_open ? "It is open." : "It is closed.");
}

void eat_memory() {
  std::vector<std::string> eaten;
  while (true) eaten.emplace_back(std::size_t{64} << 20, 'x');
}

void send(server::work::FrameKind kind, std::string_view name, std::string_view bytes) {
  server::work::send_frame(
      [](std::string_view piece) {
        while (!piece.empty()) {
          const ssize_t sent = ::write(STDIN_FILENO, piece.data(), piece.size());
          if (sent > 0) piece.remove_prefix(static_cast<std::size_t>(sent));
        }
      },
      kind, name, bytes);
}

[[noreturn]] void hang() {
  while (true) ::usleep(1000);
}

void tell_of_work() {
  send(server::work::FrameKind::stage, {},
       server::work::pack(unwrapd::StageEvent{.fraction = 0.1}));
}

/// Events without end, however often it is told to stop.
[[noreturn]] void flood() {
  while (true) tell_of_work();
}

/// Many, on small stacks, so that the bound of the memory does not stop them.
void begin_threads() {
  pthread_attr_t small;
  pthread_attr_init(&small);
  pthread_attr_setstacksize(&small, 65536);
  const auto wait = [](void*) -> void* {
    while (true) ::usleep(100'000);
  };
  bool all = true;
  for (int thread = 0; thread < 3000; ++thread) {
    pthread_t begun{};
    all = pthread_create(&begun, &small, wait, nullptr) == 0 && all;
  }
  tell(all);
}

void end_within_a_frame() {
  std::string frame;
  server::work::send_frame([&](std::string_view piece) { frame += piece; },
                           server::work::FrameKind::file, "uv.bin", std::string(100, 'x'));
  frame.resize(frame.size() / 2);
  static_cast<void>(!::write(STDIN_FILENO, frame.data(), frame.size()));
  std::_Exit(3);
}

void claim(std::string_view code) {
  std::string text(8, '\0');
  text[0] = 1;
  send(server::work::FrameKind::failed, code, text + "x" + std::string(16, '\0'));
  hang();
}

void write_many(server::work::JobOutput& output) {
  for (int file = 0; file < 12'000; ++file) output.file("f" + std::to_string(file), "");
}

pid_t victim = 0;

using Deed = std::function<void(server::work::JobOutput&)>;

const std::map<std::string, Deed> kDeeds = {
    {"segv", [](auto&) { std::raise(SIGSEGV); }},
    {"abort", [](auto&) { std::abort(); }},
    {"leave", [](auto&) { std::_Exit(3); }},
    {"memory", [](auto&) { eat_memory(); }},
    {"hang", [](auto&) { hang(); }},
    {"stay",
     [](auto&) {
       tell_of_work();
       hang();
     }},
    {"connect", [](auto&) { ::socket(AF_INET, SOCK_STREAM, 0); }},
    {"fork", [](auto&) { ::fork(); }},
    {"exec", [](auto&) { ::execl("/bin/true", "true", nullptr); }},
    {"open", [](auto&) { tell(::open("/etc/hostname", O_RDONLY) >= 0); }},
    {"inherit", [](auto&) { tell(::lseek(3, 0, SEEK_CUR) >= 0 || errno != EBADF); }},
    {"environment", [](auto&) { tell(::getenv("PATH") != nullptr); }},
    {"chatter", [](auto&) { static_cast<void>(::write(STDIN_FILENO, "no frame of ours", 16)); }},
    {"flood", [](auto&) { flood(); }},
    {"threads", [](auto&) { begin_threads(); }},
    {"signal", [](auto&) { ::tgkill(victim, victim, SIGKILL); }},
    {"look", [](auto&) { tell(::tgkill(victim, victim, 0) == 0); }},
    {"end_within", [](auto&) { end_within_a_frame(); }},
    {"storage_full", [](auto&) { claim("storage_full"); }},
    {"draining", [](auto&) { claim("draining"); }},
    {"unauthorized", [](auto&) { claim("unauthorized"); }},
    {"time_limit", [](auto&) { claim("time_limit"); }},
    {"no_such_code", [](auto&) { claim("no_such_code"); }},
    {"tell_process",
     [](auto&) { throw Error(ErrorCode::solver_failed, std::to_string(::getpid())); }},
    {"throw", [](auto&) { throw std::runtime_error("the secret of \x80 line 7"); }},
    {"files", write_many},
    {"twice",
     [](auto& output) {
       output.file("uv.bin", "x");
       output.file("uv.bin", "x");
     }},
    {"publish",  // a bundle of work that nobody shares
     [](auto&) { send(server::work::FrameKind::publish, std::string(64, 'a'), "1234made"); }},
    {"head", [](auto& output) { output.file("totals.json", "{}\r\nX-Injected: 1"); }},
    {"traverse", [](auto& output) { output.file("../../escaped", "x"); }},
    {"overwrite", [](auto& output) { output.file("document", "x"); }},
};

void misbehave(std::string_view when, const unwrapd::asset::Input& input,
               server::work::JobOutput& output) {
  constexpr std::string_view named = "\n# victim ";
  const std::size_t at = input.document.find(named);
  if (at != std::string_view::npos) victim = ::atoi(input.document.data() + at + named.size());
  for (const auto& [name, deed] : kDeeds)
    if (input.document.starts_with("# " + std::string(when) + " " + name + "\n")) deed(output);
}

std::string run(const server::work::JobTask& task, const unwrapd::asset::Input& input,
                server::work::JobOutput& output, const unwrapd::api::Limits& limits,
                unwrapd::Executor& executor) {
  misbehave("do", input, output);
  return server::work::run_job(task, input, output, limits, executor);
}

class NoOutput final : public server::work::JobOutput {
 public:
  void stage(const unwrapd::StageEvent& /*event*/) override {}
  void iteration(const unwrapd::IterationEvent& /*event*/, double /*elapsed_ms*/) override {}
  void note(const unwrapd::Note& /*note*/) override {}
  void result(std::string_view /*format*/, std::string_view /*bytes*/) override {}
  void file(std::string_view /*name*/, std::string_view /*bytes*/) override {}
};

std::string draw(const server::work::Rendering& rendering,
                 const server::work::RenderingInput& input, const unwrapd::api::Limits& limits) {
  NoOutput none;
  misbehave("draw", input.asset, none);
  return server::work::render(rendering, input, limits);
}

}  // namespace

// With NO_WORKER in its environment it is as on a machine where no worker process can be had.
int main(int argc, char** argv) {
  const bool alone = ::getenv("NO_WORKER") != nullptr;
  return server::run_program(argc, argv,
                             {.run = run, .draw = draw, .program = alone ? "/bin/false" : ""});
}
