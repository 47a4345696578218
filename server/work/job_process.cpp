#include "server/work/job_process.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <stdexcept>

#include "server/base/threads.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/work/conversation.hpp"
#include "server/work/job_frames.hpp"
#include "server/work/job_worker.hpp"
#include "server/work/lambda_selection.hpp"
#include "server/work/sandbox.hpp"
#include "server/work/warm_heap.hpp"
#include "server/work/worker_process.hpp"

namespace unwrapd::server::work {
namespace {

constexpr std::int64_t kProgramReserve = std::int64_t{256} << 20;
constexpr std::int64_t kThreadReserve = std::int64_t{80} << 20;  // its stack and its arena
constexpr int kSpareSeconds = 60;  // of processor time: the deadline comes first
constexpr std::chrono::seconds kProbePatience{20};

SandboxLimits sandbox_limits(const api::Limits& limits, const Isolation& isolation) {
  const std::int64_t seconds =
      (std::int64_t{limits.max_job_seconds} + kSpareSeconds) * isolation.threads;
  return {.memory_bytes = isolation.memory_bytes + kKeptForMesh + kProgramReserve +
                          isolation.threads * kThreadReserve,
          .processor_seconds =
              static_cast<int>(std::min<std::int64_t>(seconds, std::numeric_limits<int>::max())),
          .threads = isolation.threads};
}

void send_asset(Conversation& worker, const asset::Input& input) {
  worker.send(FrameKind::document, {}, input.document);
  for (const auto& [uri, bytes] : input.buffers) worker.send(FrameKind::buffer, uri, bytes);
}

/// Whether the options have lists, other than of lambdas: of vertices, edges or islands, by which
/// somebody else's job on a mesh that all know could reach the next one.
bool has_lists(const api::Json& options) {
  for (const auto& [name, value] : options.items())
    if (value.is_array() && !value.empty() && name != "lambda") return true;
  return false;
}

/// The mesh of a job and its owner, whose further jobs the same process may do; empty for none. Of
/// a mesh in several parts the name of one says too little; after a crash a job has a new process.
std::string mesh_of(const JobTask& task, const asset::Input& input) {
  const store::JobRecord& job = task.record;
  if (!input.buffers.empty() || job.input.sha256.empty()) return {};
  if (job.process_ends > 0 || has_lists(job.options)) return {};
  return job.owner + ' ' + job.input.sha256;
}

/// A worker process that has received the whole job by tell(): one that has done a job of this
/// mesh, a spare one, or else a new one. A process that ends before that, maybe while it waited,
/// does not count against the job.
template <class Tell>
std::unique_ptr<WorkerProcess> worker_on(const Isolation& isolation, const api::Limits& limits,
                                         const Stopping& stopping, const Tell& tell,
                                         const std::string& mesh = {}) {
  const auto told = [&](StartedWorker started) {
    auto worker = std::make_unique<WorkerProcess>(std::move(started), stopping);
    NoOutput none;
    Conversation conversation(*worker, none, isolation.memory_bytes);
    conversation.await_ready();
    tell(conversation);
    conversation.send(FrameKind::begin, {}, {});
    // It has all of it: what was sent may lie in the socket of a process that has ended.
    conversation.await_ready();
    return worker;
  };
  const auto tried = [&](std::optional<StartedWorker> waiting) -> std::unique_ptr<WorkerProcess> {
    try {
      if (waiting) return told(std::move(*waiting));
    } catch (const std::exception&) {  // whatever it says before it has the job
      if (stopping.stop.stop_requested()) throw;
    }
    return nullptr;
  };
  if (isolation.spares) {
    if (auto worker = tried(isolation.spares->take_back(mesh))) return worker;
    if (auto worker = tried(isolation.spares->take())) return worker;
  }
  return told(StartedWorker(isolation.program, sandbox_limits(limits, isolation)));
}

/// Calls use(stop token), which needs a worker process. Throws Error{internal} when there is none.
template <class Use>
void try_out(Use use) {
  const auto cannot = [](const std::string& why) {
    return Error(ErrorCode::internal,
                 "A worker process cannot run here: " + why + "; run with --isolate=off.");
  };
  std::stop_source late;
  const Deadline deadline(kProbePatience, [&] { late.request_stop(); });
  try {
    use(late.get_token());
  } catch (const Error& error) {
    throw cannot(error.code() == ErrorCode::cancelled ? "it does not answer" : error.what());
  } catch (const std::exception& error) {  // it has crashed, or something unforeseen was thrown
    throw cannot(error.what());
  }
}

}  // namespace

void check_isolation(const Isolation& isolation) {
  try_out([&](const std::stop_token& stop) {
    WorkerProcess worker(StartedWorker(isolation.program, sandbox_limits({}, isolation)),
                         {stop, isolation.grace});
    NoOutput none;
    Conversation(worker, none, isolation.memory_bytes).await_ready();
  });
}

/// Runs a whole job: the calls that the C library makes differ between machines.
std::string why_not(const Isolation& isolation) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static_cast<void>(isolation);
  return "A sanitizer needs more memory and files than a worker process may have.";
#else
  const asset::Input triangle{.document = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", .buffers = {}};
  store::JobRecord record;
  record.options = api::Json::object();
  NoOutput none;
  try {
    try_out([&](const std::stop_token& stop) {
      const JobTask task{.record = record, .began = std::chrono::steady_clock::now(), .stop = stop};
      run_job_isolated(task, triangle, none, {}, isolation);
    });
    return {};
  } catch (const Error& error) {
    return error.what();
  }
#endif
}

std::shared_ptr<SpareWorkers> spare_workers(int count, const api::Limits& limits,
                                            const Isolation& isolation) {
  const auto start = [program = isolation.program, bounds = sandbox_limits(limits, isolation)] {
    SandboxLimits warm = bounds;
    warm.warm_bytes = heap_of_largest_child();
    return StartedWorker(program, warm);
  };
  return std::make_shared<SpareWorkers>(count, start);
}

std::unique_ptr<WorkerProcess> worker_for(const JobTask& task, bool is_helper,
                                          const asset::Input& input, const api::Limits& limits,
                                          const Isolation& isolation,
                                          const std::string& mesh = {}) {
  const auto tell = [&](Conversation& conversation) {
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - task.began;
    const WorkerTask shape{.limits = limits,
                           .memory_bytes = isolation.memory_bytes,
                           .queue_ms = task.queue_ms,
                           .elapsed_ms = elapsed.count(),
                           .is_shared = task.desk != nullptr,
                           .is_helper = is_helper};
    conversation.send(FrameKind::task, {}, pack_task(shape, task.record));
    send_asset(conversation, input);
  };
  return worker_on(isolation, limits, {task.stop, isolation.grace, isolation.on_kill}, tell, mesh);
}

std::string run_job_isolated(const JobTask& task, const asset::Input& input, JobOutput& output,
                             const api::Limits& limits, const Isolation& isolation) {
  const auto begun = std::chrono::steady_clock::now();
  const std::string mesh = mesh_of(task, input);
  const auto worker = worker_for(task, false, input, limits, isolation, mesh);
  const std::size_t maps = map_count(task.record);
  std::string format =
      Conversation(*worker, output, isolation.memory_bytes, maps, task.desk).listen();
  if (!isolation.spares || mesh.empty()) return format;
  if (auto answered = worker->release())
    isolation.spares->give_back(mesh, std::move(*answered),
                                std::chrono::steady_clock::now() - begun);
  return format;
}

void help_isolated(const JobTask& task, const asset::Input& input, const api::Limits& limits,
                   const Isolation& isolation) {
  const auto worker = worker_for(task, true, input, limits, isolation);
  NoOutput none;
  try {
    Conversation(*worker, none, isolation.memory_bytes, 0, task.desk).listen();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) throw;
  }
}

std::string render_isolated(const Rendering& rendering, const RenderingInput& input,
                            const std::stop_token& stop, const api::Limits& limits,
                            const Isolation& isolation) {
  const auto tell = [&](Conversation& conversation) {
    const WorkerTask shape{
        .limits = limits, .memory_bytes = isolation.memory_bytes, .rendering = rendering};
    conversation.send(FrameKind::task, {}, pack_task(shape, input.record));
    send_asset(conversation, input.asset);
    conversation.send(FrameKind::uvs, {}, input.uvs);
    conversation.send(FrameKind::report, {}, input.report);
  };
  const auto worker = worker_on(isolation, limits, {stop, isolation.grace}, tell);
  NoOutput none;
  return Conversation(*worker, none, isolation.memory_bytes).listen_for_file();
}

}  // namespace unwrapd::server::work
