#include "server/work/spare_workers.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include "server/base/threads.hpp"

namespace unwrapd::server::work {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kWaitsForMesh{30};
constexpr std::chrono::seconds kMostOfAJob{2};
constexpr std::int64_t kMostHeld = std::int64_t{256} << 20;
constexpr std::chrono::seconds kMostWorked{30};  // its processor time is bounded in all
constexpr std::size_t kKnownMeshes = 256;
constexpr std::chrono::hours kNoEnd{1};

}  // namespace

SpareWorkers::SpareWorkers(int count, std::function<StartedWorker()> start)
    : count_(static_cast<std::size_t>(count)),
      start_(std::move(start)),
      keeping_([this](const std::stop_token& stop) { keep(stop); }) {}

std::optional<StartedWorker> SpareWorkers::take() {
  const std::lock_guard lock(mutex_);
  has_failed_ = false;
  wanted_.notify_one();
  if (spares_.empty()) return std::nullopt;
  std::optional<StartedWorker> spare(std::move(spares_.front()));
  spares_.pop_front();
  return spare;
}

std::optional<StartedWorker> SpareWorkers::take_back(const std::string& mesh) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(returned_, mesh, &Returned::mesh);
  if (found == returned_.end()) return std::nullopt;
  std::optional<StartedWorker> worker(std::move(found->worker));
  returned_.erase(found);
  return worker;
}

void SpareWorkers::give_back(const std::string& mesh, StartedWorker worker, Clock::duration job) {
  worker.count(job);
  const bool may_stay = worker.is_lasting() && job <= kMostOfAJob &&
                        worker.worked() <= kMostWorked &&
                        worker.held_bytes().value_or(kMostHeld + 1) <= kMostHeld;
  std::list<Returned> oldest;  // ends outside of the lock
  const std::lock_guard lock(mutex_);
  if (!note_mesh(mesh) || !may_stay || count_ == 0) return;
  if (returned_.size() == count_) oldest.splice(oldest.begin(), returned_, returned_.begin());
  returned_.push_back({mesh, std::move(worker), Clock::now() + kWaitsForMesh});
  has_returned_ = true;
  wanted_.notify_one();
}

/// There is a job of it now. Returns whether there was one not long ago.
bool SpareWorkers::note_mesh(const std::string& mesh) {
  if (std::ranges::find(known_, mesh) != known_.end()) return true;
  known_.push_back(mesh);
  if (known_.size() > kKnownMeshes) known_.pop_front();
  return false;
}

/// Processes end outside of the lock: the kernel takes their memory back first.
void SpareWorkers::end_late(std::unique_lock<std::mutex>& lock) {
  std::list<Returned> late;
  while (!returned_.empty() && returned_.front().until <= Clock::now())
    late.splice(late.end(), returned_, returned_.begin());
  lock.unlock();
  late.clear();
  lock.lock();
}

void SpareWorkers::keep(const std::stop_token& stop) {
  give_way();
  const auto is_wanted = [this] { return spares_.size() < count_ && !has_failed_; };
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    has_returned_ = false;
    const Time due = returned_.empty() ? Clock::now() + kNoEnd : returned_.front().until;
    wanted_.wait_until(lock, stop, due, [&] { return is_wanted() || has_returned_; });
    end_late(lock);
    if (!is_wanted() || stop.stop_requested()) continue;
    lock.unlock();
    std::optional<StartedWorker> spare = started();
    lock.lock();
    has_failed_ = !spare;
    if (spare) spares_.push_back(std::move(*spare));
  }
}

/// Errors are dropped: a job that finds no spare starts its own process and reports why that fails.
std::optional<StartedWorker> SpareWorkers::started() const {
  try {
    std::optional<StartedWorker> worker = start_();
    worker->set_lasting();
    return worker;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace unwrapd::server::work
