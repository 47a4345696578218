#include "server/webhook_pool.hpp"

#include <utility>

namespace unwrapd::server {

WebhookPool::WebhookPool(int at_once, int per_host, std::function<void()> freed)
    : at_once_(at_once), per_host_(per_host), freed_(std::move(freed)) {
  threads_.reserve(static_cast<std::size_t>(at_once));
  for (int i = 0; i < at_once; ++i)
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
}

WebhookPool::~WebhookPool() {
  for (std::jthread& thread : threads_) thread.request_stop();
  threads_.clear();
}

bool WebhookPool::is_full() const {
  const std::lock_guard lock(mutex_);
  return taken_ >= at_once_;
}

bool WebhookPool::has_room(const std::string& host) const {
  const std::lock_guard lock(mutex_);
  const auto known = of_host_.find(host);
  return taken_ < at_once_ && (known == of_host_.end() || known->second < per_host_);
}

void WebhookPool::begin(const std::string& host, Call call) {
  {
    const std::lock_guard lock(mutex_);
    ++of_host_[host];
    ++taken_;
    waiting_.push_back({host, std::move(call)});
  }
  arrived_.notify_one();
}

void WebhookPool::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (arrived_.wait(lock, stop, [&] { return !waiting_.empty(); }) && !stop.stop_requested()) {
    const Task task = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    task.call(stop);
    lock.lock();
    --taken_;
    if (--of_host_[task.host] == 0) of_host_.erase(task.host);
    lock.unlock();
    freed_();
    lock.lock();
  }
}

}  // namespace unwrapd::server
