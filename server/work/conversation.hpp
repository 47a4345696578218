#pragma once
// What a server and one worker process say to each other, from the server's side: what it receives
// is checked, as a hostile mesh may have taken the process over.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/work/job_frames.hpp"
#include "server/work/socket_work.hpp"
#include "server/work/worker_answer.hpp"
#include "server/work/worker_process.hpp"

namespace unwrapd::server::work {

/// Throws what the worker ends with, and WorkerCrashed for an answer that is invalid.
class Conversation {
 public:
  /// max_bytes: that may come; maps: the number of maps of the job; desk: see JobTask.
  Conversation(WorkerProcess& worker, JobOutput& output, std::int64_t max_bytes,
               std::size_t maps = 0, WorkDesk* desk = nullptr)
      : worker_(worker), output_(output), left_(max_bytes), files_(maps), desk_(desk) {}

  void send(FrameKind kind, std::string_view name, std::string_view bytes);
  void await_ready();
  /// Hands over all frames until the end. Returns the format of the result.
  std::string listen();
  /// The only file of an answer, if there is one.
  std::string listen_for_file();

 private:
  Frame next();
  void hand_over(const Frame& frame);
  void ask_desk(const Frame& frame);
  void hand_over_event(const Frame& frame);

  WorkerProcess& worker_;
  JobOutput& output_;
  std::int64_t left_;  // bytes that may still come
  AnswerFiles files_;
  DeskConversation desk_;
};

}  // namespace unwrapd::server::work
