#pragma once
// Limits which files (pictures, results in another format) are made at the same time. A file is
// made by one request at a time; the others that ask for it then find it made. Only so many are
// made at once as fit into memory together. Nobody holds more than half of the places, or of those
// to wait, so that a small picture need not wait for another client's large ones; apart from that,
// the order is that of arrival. Of the costly files, which are not stored, one is made at a time in
// all: a client that asks for one after another takes one thread. A client that disconnects waits
// no more.

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <list>
#include <mutex>
#include <string>

#include "server/base/concurrency_limit.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::results {

struct RenderLimits {
  int places = 2;         ///< files made at once
  int waiting = 32;       ///< requests that wait for a place; more are turned away
  std::size_t bytes = 0;  ///< of memory for all at work; one alone may take more
};

/// How often a waiting request looks whether its client is still connected.
inline constexpr std::chrono::milliseconds kPresenceLook{100};

/// Ends a request whose client has disconnected. Nobody reads it but the log.
Error client_left();

/// A file that is to be made.
struct RenderRequest {
  std::string file;       ///< its name, unlike all others
  std::string holder;     ///< of its share; not empty
  std::size_t bytes = 0;  ///< of memory that it may take
  bool is_costly = false;
};

/// Thread-safe.
class RenderLimiter {
 public:
  explicit RenderLimiter(const RenderLimits& limits)
      : places_(limits.places, half_of_all),
        places_to_wait_(limits.waiting, half_of_all),
        most_bytes_(limits.bytes) {}

  /// Waits for a place, which is the caller's while it keeps what is returned. Throws
  /// RetryLater{rate_limited} when too many wait, Error{cancelled} when the client has left.
  [[nodiscard]] std::shared_ptr<void> enter(const RenderRequest& request,
                                            const http::HasLeft& has_left = {});
  [[nodiscard]] int waiting() const { return places_to_wait_.count(); }

 private:
  /// Holds a place to wait, then one to make its file.
  struct Visitor {
    RenderRequest request;
    ConcurrencyLimit::Place to_wait;
    ConcurrencyLimit::Place to_make = nullptr;
  };
  using Visitors = std::list<Visitor>;

  ConcurrencyLimit::Place place_to_wait(const std::string& holder);
  void await_place(std::unique_lock<std::mutex>& lock, const Visitor& visitor,
                   const http::HasLeft& has_left);
  [[nodiscard]] bool is_held_up(const RenderRequest& request) const;
  [[nodiscard]] bool fits_memory(const RenderRequest& request) const;
  void let_in();
  void leave(Visitors::iterator visitor);

  ConcurrencyLimit places_;
  ConcurrencyLimit places_to_wait_;
  const std::size_t most_bytes_;
  std::mutex mutex_;
  std::condition_variable let_in_;
  Visitors visitors_;  // in order of arrival
};

}  // namespace unwrapd::server::results
