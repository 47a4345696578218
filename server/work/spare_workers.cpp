#include "server/work/spare_workers.hpp"

#include <exception>
#include <utility>

#include "server/base/threads.hpp"

namespace unwrapd::server::work {

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

void SpareWorkers::keep(const std::stop_token& stop) {
  give_way();
  const auto is_wanted = [this] { return spares_.size() < count_ && !has_failed_; };
  std::unique_lock lock(mutex_);
  while (wanted_.wait(lock, stop, is_wanted) && !stop.stop_requested()) {
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
    return start_();
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace unwrapd::server::work
