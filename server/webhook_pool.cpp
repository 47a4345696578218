#include "server/webhook_pool.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd::server {
namespace {

constexpr std::size_t kHostsRemembered = 1024;

}  // namespace

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

bool WebhookPool::is_proven(const std::string& host) const {
  return std::ranges::find(proven_, host) != proven_.end();
}

bool WebhookPool::has_room(const std::string& host) const {
  const std::lock_guard lock(mutex_);
  const auto known = of_host_.find(host);
  const int of_host = known == of_host_.end() ? 0 : known->second;
  if (is_proven(host)) return taken_ < at_once_ && of_host < per_host_;
  int of_unproven = 0;
  for (const auto& [name, count] : of_host_)
    if (!is_proven(name)) of_unproven += count;
  return taken_ < at_once_ && of_host == 0 && of_unproven < at_once_ / 2;
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
    const bool answered = task.call(stop);
    end(task.host, answered);
    freed_();
    lock.lock();
  }
}

void WebhookPool::end(const std::string& host, bool answered) {
  const std::lock_guard lock(mutex_);
  --taken_;
  if (--of_host_[host] == 0) of_host_.erase(host);
  proven_.remove(host);
  if (answered) proven_.push_front(host);
  if (proven_.size() > kHostsRemembered) proven_.pop_back();
}

}  // namespace unwrapd::server
