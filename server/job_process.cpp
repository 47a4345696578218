#include "server/job_process.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <limits>

#include "api/error_table.hpp"
#include "server/blob_store.hpp"
#include "server/byte_pack.hpp"
#include "server/job_frames.hpp"
#include "server/job_worker.hpp"
#include "server/sandbox.hpp"
#include "server/worker_process.hpp"

namespace unwrapd::server {
namespace {

constexpr std::int64_t kProgramReserve = std::int64_t{256} << 20;
constexpr std::int64_t kThreadReserve = std::int64_t{80} << 20;  // its stack and its arena
constexpr int kSpareSeconds = 60;  // of processor time: the deadline comes first
constexpr std::size_t kMaxFileName = 40;

SandboxLimits sandbox_limits(const api::Limits& limits, const Isolation& isolation) {
  const std::int64_t seconds =
      (std::int64_t{limits.max_job_seconds} + kSpareSeconds) * isolation.threads;
  return {
      .memory_bytes = isolation.memory_bytes + kProgramReserve + isolation.threads * kThreadReserve,
      .processor_seconds =
          static_cast<int>(std::min<std::int64_t>(seconds, std::numeric_limits<int>::max()))};
}

/// A name that a worker may give to a file: a plain one, and none of the input's.
bool is_answer_file(std::string_view name) {
  const bool plain =
      !name.empty() && name.size() <= kMaxFileName && name.front() != '.' &&
      std::ranges::all_of(name, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '_';
      });
  return plain && !name.starts_with(kDocumentFile) && !name.starts_with("buffer") &&
         !name.starts_with("digests") && !name.starts_with("options") &&
         !name.starts_with("result.");
}

bool is_format(std::string_view name) { return name == "glb" || name == "gltf" || name == "obj"; }

[[noreturn]] void misbehaved() { throw WorkerCrashed("it sent what no worker sends"); }

bool is_utf8(const std::string& text) {
  try {
    static_cast<void>(api::Json(text).dump());
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

/// The error that a worker tells of; one that it cannot know of counts as internal.
[[noreturn]] void rethrow(const Frame& frame) {
  ByteUnpacker from(frame.bytes);
  const std::string message(from.next_text());
  const std::string where(from.next_text());
  if (!is_utf8(message) || !is_utf8(where)) misbehaved();
  throw Error(api::code_named(frame.name).value_or(ErrorCode::internal), message, where);
}

/// One conversation with a worker.
class Conversation {
 public:
  Conversation(WorkerProcess& worker, JobOutput& output, std::int64_t max_bytes)
      : worker_(worker), output_(output), left_(max_bytes) {}

  void send(FrameKind kind, std::string_view name, std::string_view bytes) {
    send_frame([&](std::string_view piece) { worker_.send(piece); }, kind, name, bytes);
  }

  void await_ready() {
    const Frame frame = next();
    if (frame.kind == FrameKind::failed) rethrow(frame);
    if (frame.kind != FrameKind::ready) misbehaved();
  }

  /// Hands over what comes, until the end. Returns the format of the result.
  std::string listen() {
    while (true) {
      const Frame frame = next();
      if (frame.kind == FrameKind::failed) rethrow(frame);
      if (frame.kind == FrameKind::done && is_format(frame.name)) return frame.name;
      hand_over(frame);
    }
  }

  /// The one file that comes, or none.
  std::string listen_for_file() {
    const Frame frame = next();
    if (frame.kind == FrameKind::failed) rethrow(frame);
    if (frame.kind != FrameKind::rendered) misbehaved();
    return frame.bytes;
  }

 private:
  Frame next() {
    Frame frame;
    const auto receive = [&](char* data, std::size_t size) { return worker_.receive(data, size); };
    if (!receive_frame(receive, left_, frame)) worker_.reap();
    left_ -= static_cast<std::int64_t>(frame.bytes.size());
    return frame;
  }

  void hand_over(const Frame& frame) {
    if (frame.kind == FrameKind::stage) return unpack_stage(frame.bytes, output_);
    if (frame.kind == FrameKind::iteration) return unpack_iteration(frame.bytes, output_);
    if (frame.kind == FrameKind::result && is_format(frame.name))
      return output_.result(frame.name, frame.bytes);
    if (frame.kind == FrameKind::file && is_answer_file(frame.name))
      return output_.file(frame.name, frame.bytes);
    misbehaved();
  }

  WorkerProcess& worker_;
  JobOutput& output_;
  std::int64_t left_;  // bytes that may still come
};

void send_limits(WorkerProcess& worker, const SandboxLimits& limits) {
  BytePacker bytes;
  worker.send(bytes.add(limits).take());
}

void send_asset(Conversation& worker, const asset::Input& input) {
  worker.send(FrameKind::document, {}, input.document);
  for (const auto& [uri, bytes] : input.buffers) worker.send(FrameKind::buffer, uri, bytes);
}

class NoOutput final : public JobOutput {
 public:
  void stage(const StageEvent& /*event*/) override {}
  void iteration(const IterationEvent& /*event*/, double /*elapsed_ms*/) override {}
  void result(std::string_view /*format*/, std::string_view /*bytes*/) override {}
  void file(std::string_view /*name*/, std::string_view /*bytes*/) override {}
};

}  // namespace

void check_isolation(const Isolation& isolation) {
  try {
    WorkerProcess worker(isolation.program, {});
    send_limits(worker, sandbox_limits({}, isolation));
    NoOutput none;
    Conversation(worker, none, isolation.memory_bytes).await_ready();
  } catch (const WorkerCrashed& crash) {
    throw Error(ErrorCode::internal, std::string("A worker process cannot run here: ") +
                                         crash.what() + "; run without --isolate.");
  }
}

bool can_isolate(const Isolation& isolation) {
  try {
    check_isolation(isolation);
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::string run_job_isolated(const JobTask& task, const asset::Input& input, JobOutput& output,
                             const api::Limits& limits, const Isolation& isolation) {
  const std::chrono::duration<double, std::milli> elapsed =
      std::chrono::steady_clock::now() - task.began;
  WorkerProcess worker(isolation.program, task.stop);
  send_limits(worker, sandbox_limits(limits, isolation));
  Conversation conversation(worker, output, isolation.memory_bytes);
  conversation.await_ready();
  const WorkerTask shape{.limits = limits,
                         .threads = isolation.threads,
                         .memory_bytes = isolation.memory_bytes,
                         .queue_ms = task.queue_ms,
                         .elapsed_ms = elapsed.count()};
  conversation.send(FrameKind::task, {}, pack_task(shape, task.record));
  send_asset(conversation, input);
  conversation.send(FrameKind::begin, {}, {});
  return conversation.listen();
}

std::string render_isolated(const Rendering& rendering, const RenderingInput& input,
                            const std::stop_token& stop, const api::Limits& limits,
                            const Isolation& isolation) {
  WorkerProcess worker(isolation.program, stop);
  send_limits(worker, sandbox_limits(limits, isolation));
  NoOutput none;
  Conversation conversation(worker, none, isolation.memory_bytes);
  conversation.await_ready();
  const WorkerTask shape{.limits = limits,
                         .threads = isolation.threads,
                         .memory_bytes = isolation.memory_bytes,
                         .rendering = rendering};
  conversation.send(FrameKind::task, {}, pack_task(shape, input.record));
  send_asset(conversation, input.asset);
  conversation.send(FrameKind::uvs, {}, input.uvs);
  conversation.send(FrameKind::report, {}, input.report);
  conversation.send(FrameKind::begin, {}, {});
  return conversation.listen_for_file();
}

}  // namespace unwrapd::server
