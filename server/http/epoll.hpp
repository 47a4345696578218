#pragma once
// Linux's epoll, level triggered: what is not dealt with now is told of again.

#include <sys/epoll.h>

#include <array>
#include <span>

namespace unwrapd::server::http {

/// Not for use by two threads at once.
class Epoll {
 public:
  Epoll();
  Epoll(const Epoll&) = delete;
  Epoll& operator=(const Epoll&) = delete;
  ~Epoll();

  /// Events are those of poll(), which are the same bits; errors and hang-ups are told always.
  void add(int descriptor, short events) const { control(EPOLL_CTL_ADD, descriptor, events); }
  void change(int descriptor, short events) const { control(EPOLL_CTL_MOD, descriptor, events); }
  void remove(int descriptor) const { control(EPOLL_CTL_DEL, descriptor, 0); }
  /// What is ready after at most so long (-1: as long as it takes); valid until the next call.
  [[nodiscard]] std::span<const epoll_event> wait(int patience_ms);

 private:
  void control(int operation, int descriptor, short events) const;

  const int epoll_;
  std::array<epoll_event, 256> ready_{};
};

}  // namespace unwrapd::server::http
