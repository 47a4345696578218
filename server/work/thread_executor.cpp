#include "server/work/thread_executor.hpp"

namespace unwrapd::server::work {

ThreadExecutor::ThreadExecutor(int threads, SharedCache* core) : core_(core) {
  helpers_.reserve(static_cast<std::size_t>(threads));
  for (int helper = 1; helper < threads; ++helper)
    helpers_.emplace_back([this](const std::stop_token& stop) { serve(stop); });
}

ThreadExecutor::~ThreadExecutor() {
  for (std::jthread& helper : helpers_) helper.request_stop();
  helpers_.clear();
}

void ThreadExecutor::for_each_block(int block_count, const std::function<void(int)>& body) {
  if (helpers_.empty() || block_count <= 1) {
    for (int block = 0; block < block_count; ++block) body(block);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    body_ = &body;
    block_count_ = block_count;
    next_block_ = 0;
    ++round_;
  }
  work_.notify_all();
  take_blocks(body, block_count);
  std::unique_lock lock(mutex_);
  body_ = nullptr;  // a helper that wakes up only now finds nothing to do
  done_.wait(lock, [&] { return helpers_in_round_ == 0; });
}

void ThreadExecutor::serve(const std::stop_token& stop) {
  unsigned seen = 0;
  std::unique_lock lock(mutex_);
  while (work_.wait(lock, stop, [&] { return round_ != seen; })) {
    seen = round_;
    if (body_ == nullptr) continue;
    ++helpers_in_round_;
    const std::function<void(int)>& body = *body_;
    const int block_count = block_count_;
    lock.unlock();
    take_blocks(body, block_count);
    lock.lock();
    if (--helpers_in_round_ == 0) done_.notify_one();
  }
}

void ThreadExecutor::take_blocks(const std::function<void(int)>& body, int block_count) {
  while (true) {
    const int block = next_block_.fetch_add(1);
    if (block >= block_count) return;
    body(block);
  }
}

}  // namespace unwrapd::server::work
