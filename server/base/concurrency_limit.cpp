#include "server/base/concurrency_limit.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd::server {

struct ConcurrencyLimit::State {
  State(int all, Share part) : places(all), share(std::move(part)) {}

  /// Requires the mutex, like of().
  [[nodiscard]] Refusal refusal(const std::string& owner) const {
    if (taken >= places) return Refusal::full;
    const int own = of(owner);
    const bool has_share = !owner.empty() && own >= share(places, taken - own);
    return has_share ? Refusal::share : Refusal::none;
  }

  [[nodiscard]] int of(const std::string& owner) const {
    const auto found = of_owner.find(owner);
    return found == of_owner.end() ? 0 : found->second;
  }

  void leave(const std::string& owner) {
    const std::lock_guard lock(mutex);
    --taken;
    if (--of_owner[owner] == 0) of_owner.erase(owner);
  }

  const int places;
  const Share share;
  mutable std::mutex mutex;
  int taken = 0;
  std::map<std::string, int> of_owner;
};

ConcurrencyLimit::ConcurrencyLimit(int places, Share share)
    : state_(std::make_shared<State>(places, std::move(share))) {}

ConcurrencyLimit::Place ConcurrencyLimit::try_enter(const std::string& owner, Refusal* why) {
  const std::lock_guard lock(state_->mutex);
  const Refusal refused = state_->refusal(owner);
  if (why != nullptr) *why = refused;
  if (refused != Refusal::none) return nullptr;
  ++state_->of_owner[owner];
  ++state_->taken;
  return {state_.get(), [state = state_, owner](void*) { state->leave(owner); }};
}

ConcurrencyLimit::Refusal ConcurrencyLimit::refusal(const std::string& owner) const {
  const std::lock_guard lock(state_->mutex);
  return state_->refusal(owner);
}

int ConcurrencyLimit::count() const {
  const std::lock_guard lock(state_->mutex);
  return state_->taken;
}

int ConcurrencyLimit::count(const std::string& owner) const {
  const std::lock_guard lock(state_->mutex);
  return state_->of(owner);
}

int half_of_the_rest(int places, int others) { return (places - others + 1) / 2; }

int half_of_all(int places, int) { return std::max(1, places / 2); }

int three_quarters(int places, int) { return places - places / 4; }

}  // namespace unwrapd::server
