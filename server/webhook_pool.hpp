#pragma once
// Threads that call webhooks: a few calls at once, and of these fewer to one host. A host is proven
// when it has answered its last call. Those that are not have one call each, and half of all places
// together: so receivers that hang, however many, delay neither proven ones nor, while they are
// few, new ones.

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

namespace unwrapd::server {

/// Thread-safe.
class WebhookPool {
 public:
  /// One call; it ends early when the token asks for it. Whether the host has answered.
  using Call = std::function<bool(const std::stop_token& stop)>;

  /// at_once: calls in all; per_host: of these, to one proven host; freed: called after each, by
  /// its thread, when its place is free again.
  WebhookPool(int at_once, int per_host, std::function<void()> freed);
  WebhookPool(const WebhookPool&) = delete;
  WebhookPool& operator=(const WebhookPool&) = delete;
  /// Asks all calls to end, and waits for them.
  ~WebhookPool();

  [[nodiscard]] bool is_full() const;
  /// Whether this host may be called now.
  [[nodiscard]] bool has_room(const std::string& host) const;
  /// Begins a call, for which there must be room.
  void begin(const std::string& host, Call call);

 private:
  struct Task {
    std::string host;
    Call call;
  };
  void work(const std::stop_token& stop);
  void end(const std::string& host, bool answered);
  [[nodiscard]] bool is_proven(const std::string& host) const;

  const int at_once_;
  const int per_host_;
  const std::function<void()> freed_;
  mutable std::mutex mutex_;
  std::condition_variable_any arrived_;
  std::deque<Task> waiting_;
  std::map<std::string, int> of_host_;  // waiting or being made
  int taken_ = 0;                       // the same, in all
  std::list<std::string> proven_;       // hosts, the last to answer first
  std::vector<std::jthread> threads_;   // last: they use the others
};

}  // namespace unwrapd::server
