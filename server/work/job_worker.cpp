#include "server/work/job_worker.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <new>
#include <string_view>
#include <thread>

#include "api/error_table.hpp"
#include "api/report.hpp"
#include "core/base/byte_pack.hpp"
#include "server/work/job_frames.hpp"
#include "server/work/sandbox.hpp"
#include "server/work/socket_work.hpp"
#include "server/work/solver_cache.hpp"
#include "server/work/thread_executor.hpp"
#include "server/work/warm_heap.hpp"

namespace unwrapd::server::work {
namespace {

constexpr int kSocket = STDIN_FILENO;
constexpr std::int64_t kAnyBytes = std::int64_t{1} << 40;  // the server is trusted
constexpr std::int64_t kCacheShare = 4;  // of the memory, for what the charts of a job share

/// The server has gone, or has no job for this process: there is nothing to answer.
[[noreturn]] void gone() { std::_Exit(EXIT_FAILURE); }

void send_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(kSocket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) gone();
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

bool receive_all(char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t got = ::recv(kSocket, data, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) gone();
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

/// Sends all output of a job to the server.
class SocketOutput final : public JobOutput {
 public:
  void stage(const StageEvent& event) override {
    send_frame(send_all, FrameKind::stage, {}, pack(event));
  }
  void iteration(const IterationEvent& event, double elapsed_ms) override {
    send_frame(send_all, FrameKind::iteration, {}, pack(event, elapsed_ms));
  }
  void note(const Note& note) override {
    send_frame(send_all, FrameKind::note, api::code_name(note.code), note.text);
  }
  void result(std::string_view format, std::string_view bytes) override {
    send_frame(send_all, FrameKind::result, format, bytes);
  }
  void file(std::string_view name, std::string_view bytes) override {
    send_frame(send_all, FrameKind::file, name, bytes);
  }
};

/// A job as received over the socket.
// NOLINTNEXTLINE(bugprone-exception-escape): moving a JSON value moves a pointer, and cannot throw
struct ReceivedJob {
  WorkerTask task;
  store::JobRecord record;
  std::string document;
  std::vector<std::pair<std::string, std::string>> buffers;
  std::string uvs;
  std::string report;

  [[nodiscard]] asset::Input input() const {
    asset::Input input{.document = document, .buffers = {}};
    for (const auto& [uri, bytes] : buffers) input.buffers[uri] = bytes;
    return input;
  }
};

void unpack_task(std::string_view bytes, ReceivedJob& job) {
  ByteUnpacker from(bytes);
  job.task = from.next<WorkerTask>();
  job.record.synchronous = from.next<std::uint8_t>() != 0;
  job.record.input.bytes = from.next<std::int64_t>();
  job.record.input.sha256 = from.next_text();
  job.record.options = api::Json::parse(from.next_text());
  while (!from.empty()) job.record.notes.emplace_back(from.next_text());
}

/// Stores the content of a frame. False after the last one.
bool keep(Frame& frame, ReceivedJob& job) {
  switch (frame.kind) {
    case FrameKind::task:
      unpack_task(frame.bytes, job);
      break;
    case FrameKind::document:
      job.document = std::move(frame.bytes);
      break;
    case FrameKind::buffer:
      job.buffers.emplace_back(std::move(frame.name), std::move(frame.bytes));
      break;
    case FrameKind::uvs:
      job.uvs = std::move(frame.bytes);
      break;
    case FrameKind::report:
      job.report = std::move(frame.bytes);
      break;
    default:
      break;
  }
  return frame.kind != FrameKind::begin;
}

/// Ends a process that is told to stop before its job has begun, so that no job runs.
ReceivedJob receive_job(const std::stop_token& stop) {
  const std::stop_callback end_at_stop(stop, gone);
  ReceivedJob job;
  for (Frame frame; receive_frame(receive_all, kAnyBytes, frame);)
    if (!keep(frame, job)) return job;
  gone();
}

/// SIGTERM asks for a stop. The thread waits for it as long as the process lives.
std::stop_source stop_at_sigterm() {
  std::stop_source stop;
  std::thread([stop]() mutable {
    sigset_t term;
    sigemptyset(&term);
    sigaddset(&term, SIGTERM);
    int signal = 0;
    sigwait(&term, &signal);
    stop.request_stop();
  }).detach();
  return stop;
}

/// reason: for the log of the server alone.
void fail_with(ErrorCode code, std::string_view message, std::string_view where,
               std::string_view reason = {}) {
  BytePacker text;
  text.add_text(message).add_text(where).add_text(reason);
  send_frame(send_all, FrameKind::failed, api::error_row(code).name, text.take());
}

/// All threads that the process will ever have (sandbox.hpp).
struct Crew {
  explicit Crew(int count) : threads(count) {}

  std::stop_source stop = stop_at_sigterm();
  ThreadExecutor threads;
};

/// The threads of a crew, with what the charts of one job share, and with whom.
class SharingExecutor final : public Executor {
 public:
  SharingExecutor(ThreadExecutor& threads, SharedCache& core, SharedWork* work)
      : threads_(threads), core_(core), work_(work) {}

  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    threads_.for_each_block(block_count, body);
  }
  [[nodiscard]] SharedCache* shared_cache() const override { return &core_; }
  [[nodiscard]] SharedWork* shared_work() const override { return work_; }

 private:
  ThreadExecutor& threads_;
  SharedCache& core_;
  SharedWork* work_;
};

void draw(const ReceivedJob& job, const Crew& crew, const WorkerFunctions& functions) {
  const std::stop_callback end_at_stop(  // a file half made is of no use to anybody
      crew.stop.get_token(), [] { std::_Exit(EXIT_FAILURE); });
  const RenderingInput input{
      .record = job.record, .asset = job.input(), .uvs = job.uvs, .report = job.report};
  const std::string bytes = functions.draw(*job.task.rendering, input, job.task.limits);
  send_frame(send_all, FrameKind::rendered, {}, bytes);
}

void run(const ReceivedJob& job, Crew& crew, const WorkerFunctions& functions, SolverCache& core) {
  SocketWork shared(send_all, receive_all, job.task.is_helper);
  SharingExecutor executor(crew.threads, core, job.task.is_shared ? &shared : nullptr);
  SocketOutput told;
  NoOutput none;
  JobOutput& output = job.task.is_helper ? static_cast<JobOutput&>(none) : told;
  const auto elapsed = std::chrono::duration<double, std::milli>(job.task.elapsed_ms);
  const JobTask task{
      .record = job.record,
      .queue_ms = job.task.queue_ms,
      .began = std::chrono::steady_clock::now() -
               std::chrono::duration_cast<std::chrono::steady_clock::duration>(elapsed),
      .stop = crew.stop.get_token()};
  const std::string format = functions.run(task, job.input(), output, job.task.limits, executor);
  send_frame(send_all, FrameKind::done, format, {});
}

/// Until the server ends this process, or a job fails. All jobs are of one mesh.
void work(Crew& crew, const WorkerFunctions& functions) {
  std::optional<SolverCache> core;
  while (true) {
    const ReceivedJob job = receive_job(crew.stop.get_token());
    send_frame(send_all, FrameKind::ready, {}, {});
    if (job.task.rendering) return draw(job, crew, functions);
    const std::int64_t memory = job.task.memory_bytes;
    if (!core)
      core.emplace(MemoryLimits{.cache_bytes = memory / kCacheShare, .job_bytes = memory}, 1);
    run(job, crew, functions, *core);
    if (job.task.is_helper || crew.stop.stop_requested()) return;
    core->shrink_to(kKeptForMesh);
    send_frame(send_all, FrameKind::ready, {}, {});
  }
}

/// The limits are the first message: nothing may be read without them.
SandboxLimits sandbox_limits() {
  SandboxLimits limits;
  if (!receive_all(reinterpret_cast<char*>(&limits), sizeof limits)) gone();
  return limits;
}

}  // namespace

bool is_job_worker(int argc, const char* const* argv) {
  return argc == 2 && std::string_view(argv[1]) == kWorkerFlag;
}

std::string pack_task(const WorkerTask& task, const store::JobRecord& job) {
  BytePacker pack;
  pack.add(task).add(std::uint8_t{job.synchronous}).add(job.input.bytes);
  pack.add_text(job.input.sha256).add_text(job.options.dump());
  for (const std::string& note : job.notes) pack.add_text(note);
  return pack.take();
}

int run_job_worker(const WorkerFunctions& functions) {
  try {
    be_first_to_go();
    const SandboxLimits limits = sandbox_limits();
    auto* crew = new Crew(limits.threads);  // NOLINT: its threads end with the process
    enter_sandbox(limits);
    send_frame(send_all, FrameKind::ready, {}, {});
    warm_heap(limits.warm_bytes, kSocket);
    work(*crew, functions);
  } catch (const Error& error) {
    fail_with(error.code(), error.what(), error.where());
  } catch (const std::bad_alloc&) {
    fail_with(
        ErrorCode::memory_limit,
        "The job needed more memory than this server allows for one job; send a smaller mesh.", {});
  } catch (const std::exception& error) {  // the owner learns nothing of our insides
    fail_with(ErrorCode::internal, "An internal error occurred.", {}, error.what());
  }
  std::_Exit(EXIT_SUCCESS);  // nothing is left to be done, and a thread still waits for a signal
}

}  // namespace unwrapd::server::work
