#include "server/base/concurrency_limit.hpp"

#include <algorithm>

namespace unwrapd::server {

std::shared_ptr<void> ConcurrencyLimit::let_in(const std::string& owner) {
  const std::lock_guard lock(mutex_);
  const auto found = of_owner_.find(owner);
  const int his = found == of_owner_.end() ? 0 : found->second;
  const int left_by_others = most_ - (count_ - his);
  const int most_of_one = owner.empty() ? left_by_others : (left_by_others + 1) / 2;
  if (his >= most_of_one) return nullptr;
  ++count_;
  ++of_owner_[owner];
  return {this, [owner](ConcurrencyLimit* waiters) { waiters->leave(owner); }};
}

int ConcurrencyLimit::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

void ConcurrencyLimit::leave(const std::string& owner) {
  const std::lock_guard lock(mutex_);
  --count_;
  if (--of_owner_[owner] == 0) of_owner_.erase(owner);
}

}  // namespace unwrapd::server
