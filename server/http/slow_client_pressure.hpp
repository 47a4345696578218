#pragma once
// The threads of a server that wait for clients: for bytes of a body, or until they take what they
// are sent. Slow clients must not hold all of them: where many wait, more is asked of each.

#include <atomic>

namespace unwrapd::server::http {

struct SlowClientPressure {
  int many = 0;
  std::atomic<int> waiting = 0;
};

/// This thread, among those that wait for clients.
class Waiting {
 public:
  explicit Waiting(SlowClientPressure* pressure) : pressure_(pressure) {
    if (pressure_ != nullptr) ++pressure_->waiting;
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;
  ~Waiting() {
    if (pressure_ != nullptr) --pressure_->waiting;
  }
  [[nodiscard]] bool many() const {
    return pressure_ != nullptr && pressure_->waiting > pressure_->many;
  }

 private:
  SlowClientPressure* const pressure_;
};

}  // namespace unwrapd::server::http
