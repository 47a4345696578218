#pragma once
// The threads of a server that wait for clients: for bytes of a body, or until they take what they
// are sent. Slow clients must not hold all of them: where many wait, more is asked of each.

#include <atomic>

namespace unwrapd::server {

struct Crowd {
  int many = 0;
  std::atomic<int> waiting = 0;
};

/// This thread, among those that wait for clients.
class Waiting {
 public:
  explicit Waiting(Crowd* crowd) : crowd_(crowd) {
    if (crowd_ != nullptr) ++crowd_->waiting;
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;
  ~Waiting() {
    if (crowd_ != nullptr) --crowd_->waiting;
  }
  [[nodiscard]] bool many() const { return crowd_ != nullptr && crowd_->waiting > crowd_->many; }

 private:
  Crowd* const crowd_;
};

}  // namespace unwrapd::server
