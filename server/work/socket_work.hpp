#pragma once
// The work that a worker process shares with those of other workers, asked for at the server's
// desk.

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/base/shared_work.hpp"
#include "server/work/job_frames.hpp"
#include "server/work/work_desk.hpp"

namespace unwrapd::server::work {

/// A process that helps throws Error{cancelled} when nothing is left to help with.
class SocketWork final : public SharedWork {
 public:
  SocketWork(SendAll send, ReceiveAll receive, bool is_helper)
      : send_(std::move(send)), receive_(std::move(receive)), is_helper_(is_helper) {}

  std::optional<Claim> claim(const SharedStage& stage) override;
  void publish(const SharedStage& stage, int bundle, std::string_view bytes) override;
  std::optional<std::string> obtain(const SharedStage& stage, int bundle) override;
  void finish() override;

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::chrono::milliseconds patience(double work) const;
  std::string answer();

  const SendAll send_;
  const ReceiveAll receive_;
  const bool is_helper_;
  Clock::time_point began_;  ///< the bundle that was claimed last
  double longest_ms_ = 0;    ///< for a unit of work, of the bundles of this stage
  Digest stage_ = {};
  bool is_impatient_ = false;  ///< a bundle of this stage did not come
};

/// The server's side: answers what a process asks for. The process is trusted with nothing: it
/// publishes what it has claimed, once.
class DeskConversation {
 public:
  /// desk: null where nothing is shared.
  explicit DeskConversation(WorkDesk* desk) : desk_(desk) {}

  /// The answer to a frame, in the bytes of a FrameKind::bundle; none: it needs none. Throws
  /// Error{internal} for what no sound process asks.
  std::optional<std::string> answer(const Frame& frame);

 private:
  WorkDesk* desk_;
  std::map<std::string, std::set<int>, std::less<>> claimed_;  ///< and not published
};

inline bool is_for_desk(FrameKind kind) {
  return kind == FrameKind::claim || kind == FrameKind::publish || kind == FrameKind::obtain;
}

}  // namespace unwrapd::server::work
