#pragma once
// Who may make a file (a picture, a result in another format) now. Each file is made by one at a
// time, so that whoever asks for it meanwhile finds it made; a few are made at once, no more than
// fit into the memory together. Nobody has more than half of the places, nor of those to wait, so
// that a small picture need not wait for somebody's large ones; else in order of arrival. Of those
// that cost much and are not kept, one at a time is made in all: whoever asks for one after another
// takes one thread. Who has gone does not wait any more.

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "server/http/http.hpp"

namespace unwrapd::server::results {

struct RenderLimits {
  int places = 2;         ///< files made at once
  int waiting = 32;       ///< who wait for a place; more are turned away
  std::size_t bytes = 0;  ///< of memory for all at work; one alone may take more
};

/// How often whoever waits looks whether the client is still there.
inline constexpr std::chrono::milliseconds kPresenceLook{100};

/// Nobody reads it but the log.
Error client_left();

/// A file that is to be made.
struct RenderRequest {
  std::string file;       ///< its name, unlike all others
  std::string holder;     ///< for whom
  std::size_t bytes = 0;  ///< of memory that it may take
  bool is_costly = false;
};

/// Thread-safe.
class RenderLimiter {
 public:
  explicit RenderLimiter(const RenderLimits& limits) : limits_(limits) {}

  /// Waits for a place, which is the caller's while it keeps what is returned. Throws
  /// RetryLater{rate_limited} when too many wait, Error{cancelled} when the client has left.
  [[nodiscard]] std::shared_ptr<void> enter(const RenderRequest& making,
                                            const http::HasLeft& has_left = {});
  [[nodiscard]] int waiting();

 private:
  struct Waiter {
    RenderRequest making;
    bool is_in = false;
  };
  using Waiters_ = std::list<Waiter>;

  void check_waiting(const std::string& holder) const;
  void await_place(std::unique_lock<std::mutex>& lock, const bool& is_in,
                   const http::HasLeft& has_left);
  [[nodiscard]] bool is_held_up(const RenderRequest& making) const;
  [[nodiscard]] bool fits(const RenderRequest& making) const;
  void let_in();
  void leave(Waiters_::iterator waiter);

  const RenderLimits limits_;
  std::mutex mutex_;
  std::condition_variable let_in_;
  Waiters_ waiters_;  // in order of arrival
};

}  // namespace unwrapd::server::results
