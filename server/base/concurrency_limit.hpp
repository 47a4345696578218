#pragma once
// Who may hold open what there is little of: a request until a job ends (each holds a thread of the
// server, which has so many more for them), an event stream. An API key takes
// no more than half of what the others leave it, so that no few of them take all.

#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace unwrapd::server {

/// Thread-safe. Outlives the places.
class ConcurrencyLimit {
 public:
  /// most: at a time, in all.
  explicit ConcurrencyLimit(int most) : most_(most) {}

  /// A place, the caller's while it keeps what is returned; nothing where all are taken. owner: id
  /// of the API key, empty without one.
  [[nodiscard]] std::shared_ptr<void> let_in(const std::string& owner);
  [[nodiscard]] int count() const;

 private:
  void leave(const std::string& owner);

  const int most_;
  mutable std::mutex mutex_;
  int count_ = 0;
  std::map<std::string, int> of_owner_;
};

}  // namespace unwrapd::server
