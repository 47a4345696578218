#pragma once
// Wakes a thread that waits in epoll: any other thread rings, the waiting one answers and then
// looks at everything that may be new. Rings before an answer count as one.

namespace unwrapd::server {

/// Thread-safe.
class Wakeup {
 public:
  /// Throws Error{internal} when there is no descriptor left.
  Wakeup();
  Wakeup(const Wakeup&) = delete;
  Wakeup& operator=(const Wakeup&) = delete;
  ~Wakeup();

  void ring() const;
  /// Before the look at what is new: whoever rings after it is heard again.
  void answer() const;
  /// Readable while somebody has rung.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  const int descriptor_;
};

}  // namespace unwrapd::server
