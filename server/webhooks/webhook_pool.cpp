#include "server/webhooks/webhook_pool.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd::server::webhooks {
namespace {

constexpr std::size_t kRemembered = 1024;

}  // namespace

WebhookPool::WebhookPool(int at_once, int per_receiver, std::function<void()> freed)
    : at_once_(at_once),
      per_receiver_(per_receiver),
      freed_(std::move(freed)),
      calls_(at_once, three_quarters),
      trials_(at_once / 2, three_quarters) {
  threads_.reserve(static_cast<std::size_t>(at_once));
  for (int i = 0; i < at_once; ++i)
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
}

WebhookPool::~WebhookPool() {
  for (std::jthread& thread : threads_) thread.request_stop();
  threads_.clear();
}

bool WebhookPool::is_proven(const WebhookReceiver& receiver) const {
  return std::ranges::find(proven_, receiver) != proven_.end();
}

bool WebhookPool::has_room(const WebhookReceiver& receiver) const {
  const std::lock_guard lock(mutex_);
  constexpr auto kNone = ConcurrencyLimit::Refusal::none;
  if (calls_.refusal(receiver.owner) != kNone) return false;
  const auto known = of_receiver_.find(receiver);
  const int of_receiver = known == of_receiver_.end() ? 0 : known->second;
  if (is_proven(receiver)) return of_receiver < per_receiver_;
  return of_receiver == 0 && trials_.refusal(receiver.owner) == kNone;
}

void WebhookPool::begin(const WebhookReceiver& receiver, Call call) {
  {
    const std::lock_guard lock(mutex_);
    ++of_receiver_[receiver];
    waiting_.push_back(
        {.receiver = receiver,
         .call = std::move(call),
         .place = calls_.try_enter(receiver.owner),
         .trial = is_proven(receiver) ? nullptr : trials_.try_enter(receiver.owner)});
  }
  arrived_.notify_one();
}

void WebhookPool::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (arrived_.wait(lock, stop, [&] { return !waiting_.empty(); }) && !stop.stop_requested()) {
    Task task = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    const bool answered = task.call(stop);
    end(std::move(task), answered);
    freed_();
    lock.lock();
  }
}

/// Gives the places back.
void WebhookPool::end(Task task, bool answered) {
  const std::lock_guard lock(mutex_);
  if (--of_receiver_[task.receiver] == 0) of_receiver_.erase(task.receiver);
  proven_.remove(task.receiver);
  if (answered) proven_.push_front(std::move(task.receiver));
  if (proven_.size() > kRemembered) proven_.pop_back();
}

}  // namespace unwrapd::server::webhooks
