#pragma once
// Wakes a thread that waits in epoll: any thread rings; the waiting one calls answer() and then
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
  /// Call before looking at what is new: a ring after it wakes the thread again.
  void answer() const;
  /// Readable after a ring, until answer().
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  const int descriptor_;
};

}  // namespace unwrapd::server
