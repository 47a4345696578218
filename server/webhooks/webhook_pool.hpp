#pragma once
// Threads that call webhooks: a few calls at once, and of these fewer to one receiver, which is a
// host as one owner of jobs calls it. A receiver is proven when it has answered its last call. A
// call to one that is not proven is a trial: one at a time for each receiver, and half of all
// places for the trials together. One owner has three quarters of either at most, where there are
// several. So receivers that hang, however many, delay neither proven ones nor, while they are few
// or another owner's, new ones.

#include <compare>
#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "server/base/concurrency_limit.hpp"

namespace unwrapd::server::webhooks {

/// Ordered, for maps.
struct WebhookReceiver {
  std::string owner;
  std::string host;
  auto operator<=>(const WebhookReceiver&) const = default;
};

/// Thread-safe.
class WebhookPool {
 public:
  /// One call; it ends early when the token asks for it. Whether the receiver has answered.
  using Call = std::function<bool(const std::stop_token& stop)>;

  /// at_once: calls in all; per_receiver: of these, to one that is proven; freed: called after
  /// each, by its thread, when its place is free again.
  WebhookPool(int at_once, int per_receiver, std::function<void()> freed);
  WebhookPool(const WebhookPool&) = delete;
  WebhookPool& operator=(const WebhookPool&) = delete;
  /// Asks all calls to end, and waits for them.
  ~WebhookPool();

  [[nodiscard]] bool is_full() const { return calls_.count() >= at_once_; }
  /// Whether this receiver may be called now.
  [[nodiscard]] bool has_room(const WebhookReceiver& receiver) const;
  /// Calls of this owner that wait for a thread or are being made.
  [[nodiscard]] int of_owner(const std::string& owner) const { return calls_.count(owner); }
  /// Begins a call, for which there must be room.
  void begin(const WebhookReceiver& receiver, Call call);

 private:
  struct Task {
    WebhookReceiver receiver;
    Call call;
    ConcurrencyLimit::Place place;
    ConcurrencyLimit::Place trial;  // none when the receiver is proven
  };
  void work(const std::stop_token& stop);
  void end(Task task, bool answered);
  [[nodiscard]] bool is_proven(const WebhookReceiver& receiver) const;

  const int at_once_;
  const int per_receiver_;
  const std::function<void()> freed_;
  mutable std::mutex mutex_;
  std::condition_variable_any arrived_;
  std::deque<Task> waiting_;
  ConcurrencyLimit calls_;                      // waiting or being made, each owner its share
  ConcurrencyLimit trials_;                     // of these
  std::map<WebhookReceiver, int> of_receiver_;  // the same calls
  std::list<WebhookReceiver> proven_;           // the last to answer first
  std::vector<std::jthread> threads_;           // last: they use the others
};

}  // namespace unwrapd::server::webhooks
