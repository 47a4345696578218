#include "client/in_flight.hpp"

#include <algorithm>
#include <system_error>

namespace unwrapd::client {
namespace {

constexpr std::size_t kLeastWaiting = 4;

}  // namespace

bool InFlight::may_take() const {
  if (is_over() || waiting_ + begun_ >= std::size_t{kMost}) return false;
  if (fixed_ > 0) return waiting_ + begun_ < fixed_;
  return waiting_ < std::max(kLeastWaiting, begun_);
}

void InFlight::grow() {
  if (!may_take()) return;
  if (idle_ > 0) return changed_.notify_all();
  try {
    threads_.emplace_back([this] { work(); });
    ++working_;                         // it waits for the lock
  } catch (const std::system_error&) {  // no more threads: those that there are do all
    if (working_ == 0) throw;
  }
}

void InFlight::perform(std::size_t number, std::unique_lock<std::mutex>& lock) {
  bool has_begun = false;
  const OnBegun on_begun = [&] {
    const std::scoped_lock counts(mutex_);
    if (has_begun) return;
    has_begun = true;
    --waiting_;
    ++begun_;
    grow();
  };
  lock.unlock();
  std::exception_ptr thrown;
  try {
    (*task_)(number, on_begun);
  } catch (...) {
    thrown = std::current_exception();
  }
  lock.lock();
  --(has_begun ? begun_ : waiting_);
  if (!end_) end_ = thrown;
}

void InFlight::work() {
  std::unique_lock lock(mutex_);
  while (!is_over()) {
    if (!may_take()) {
      ++idle_;
      changed_.wait(lock, [&] { return is_over() || may_take(); });
      --idle_;
      continue;
    }
    const std::size_t mine = next_++;
    ++waiting_;
    grow();
    perform(mine, lock);
  }
  --working_;
  changed_.notify_all();
}

void InFlight::run(std::size_t count, const Task& task) {
  std::unique_lock lock(mutex_);
  count_ = count;
  next_ = 0;
  end_ = nullptr;
  task_ = &task;
  grow();
  changed_.wait(lock, [&] { return working_ == 0; });
  std::vector<std::jthread> ended = std::move(threads_);
  threads_.clear();
  lock.unlock();
  ended.clear();  // joins
  if (end_) std::rethrow_exception(end_);
}

}  // namespace unwrapd::client
