#include "server/webhooks/webhook_pool.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd::server::webhooks {
namespace {

constexpr std::size_t kRemembered = 1024;

/// Of so many places, those that this owner may have: where no keys are asked for, all are one.
int share(int places, const std::string& owner) {
  return owner.empty() ? places : places - places / 4;
}

}  // namespace

WebhookPool::WebhookPool(int at_once, int per_receiver, std::function<void()> freed)
    : at_once_(at_once), per_receiver_(per_receiver), freed_(std::move(freed)) {
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

bool WebhookPool::is_proven(const WebhookReceiver& receiver) const {
  return std::ranges::find(proven_, receiver) != proven_.end();
}

template <class Is>
int WebhookPool::count(Is&& is) const {
  int found = 0;
  for (const auto& [receiver, calls] : calls_)
    if (is(receiver)) found += calls;
  return found;
}

int WebhookPool::of_owner(const std::string& owner) const {
  const std::lock_guard lock(mutex_);
  return count([&](const WebhookReceiver& other) { return other.owner == owner; });
}

bool WebhookPool::has_room(const WebhookReceiver& receiver) const {
  const std::lock_guard lock(mutex_);
  const auto is_ours = [&](const WebhookReceiver& other) { return other.owner == receiver.owner; };
  const auto is_unproven = [&](const WebhookReceiver& other) { return !is_proven(other); };
  if (taken_ >= at_once_ || count(is_ours) >= share(at_once_, receiver.owner)) return false;
  const auto known = calls_.find(receiver);
  const int of_receiver = known == calls_.end() ? 0 : known->second;
  if (is_proven(receiver)) return of_receiver < per_receiver_;
  const int places = at_once_ / 2;
  const int ours =
      count([&](const WebhookReceiver& other) { return is_ours(other) && is_unproven(other); });
  return of_receiver == 0 && count(is_unproven) < places && ours < share(places, receiver.owner);
}

void WebhookPool::begin(const WebhookReceiver& receiver, Call call) {
  {
    const std::lock_guard lock(mutex_);
    ++calls_[receiver];
    ++taken_;
    waiting_.push_back({receiver, std::move(call)});
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
    end(task.receiver, answered);
    freed_();
    lock.lock();
  }
}

void WebhookPool::end(const WebhookReceiver& receiver, bool answered) {
  const std::lock_guard lock(mutex_);
  --taken_;
  if (--calls_[receiver] == 0) calls_.erase(receiver);
  proven_.remove(receiver);
  if (answered) proven_.push_front(receiver);
  if (proven_.size() > kRemembered) proven_.pop_back();
}

}  // namespace unwrapd::server::webhooks
