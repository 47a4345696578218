#pragma once
// Threads that call webhooks: a few calls at once, and of these fewer to one host, so that a
// receiver that hangs delays its own calls only.

#include <condition_variable>
#include <deque>
#include <functional>
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
  /// One call; it ends early when the token asks for it.
  using Call = std::function<void(const std::stop_token& stop)>;

  /// at_once: calls in all; per_host: of these, to one host; freed: called after each, by its
  /// thread, when its place is free again.
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

  const int at_once_;
  const int per_host_;
  const std::function<void()> freed_;
  mutable std::mutex mutex_;
  std::condition_variable_any arrived_;
  std::deque<Task> waiting_;
  std::map<std::string, int> of_host_;  // waiting or being made
  int taken_ = 0;                       // the same, in all
  std::vector<std::jthread> threads_;   // last: they use the others
};

}  // namespace unwrapd::server
