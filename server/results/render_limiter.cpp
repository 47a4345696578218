#include "server/results/render_limiter.hpp"

#include <algorithm>

#include "server/base/retry_later.hpp"

namespace unwrapd::server::results {
namespace {

constexpr int kMakingRetrySeconds = 5;

int half_of(int count) { return std::max(1, count / 2); }

}  // namespace

Error client_left() {
  return {ErrorCode::cancelled,
          "The client closed its connection; send the request again and wait."};
}

std::shared_ptr<void> RenderLimiter::enter(const RenderRequest& making,
                                           const http::HasLeft& has_left) {
  std::unique_lock lock(mutex_);
  check_waiting(making.holder);
  const auto self = waiters_.insert(waiters_.end(), {.making = making});
  let_in();
  try {
    await_place(lock, self->is_in, has_left);
  } catch (...) {
    waiters_.erase(self);
    let_in();
    throw;
  }
  lock.unlock();
  return {nullptr, [this, self](void*) { leave(self); }};
}

void RenderLimiter::await_place(std::unique_lock<std::mutex>& lock, const bool& is_in,
                                const http::HasLeft& has_left) {
  while (!let_in_.wait_for(lock, kPresenceLook, [&] { return is_in; }))
    if (has_left && has_left()) throw client_left();
}

int RenderLimiter::waiting() {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(std::ranges::count(waiters_, false, &Waiter::is_in));
}

void RenderLimiter::check_waiting(const std::string& holder) const {
  const auto waits_for_holder = [&](const Waiter& waiter) {
    return !waiter.is_in && waiter.making.holder == holder;
  };
  if (std::ranges::count(waiters_, false, &Waiter::is_in) < limits_.waiting &&
      std::ranges::count_if(waiters_, waits_for_holder) < half_of(limits_.waiting))
    return;
  throw RetryLater(ErrorCode::rate_limited,
                   "Too many requests wait for pictures and formats; try again after Retry-After.",
                   kMakingRetrySeconds);
}

/// Whether it waits for its like, so that who came later need not wait for it.
bool RenderLimiter::is_held_up(const RenderRequest& making) const {
  const auto same_file = [&](const Waiter& waiter) {
    return waiter.is_in && waiter.making.file == making.file;
  };
  const auto same_holder = [&](const Waiter& waiter) {
    return waiter.is_in && waiter.making.holder == making.holder;
  };
  const auto costly = [](const Waiter& waiter) { return waiter.is_in && waiter.making.is_costly; };
  return std::ranges::any_of(waiters_, same_file) ||
         (making.is_costly && std::ranges::any_of(waiters_, costly)) ||
         std::ranges::count_if(waiters_, same_holder) >= half_of(limits_.places);
}

bool RenderLimiter::fits(const RenderRequest& making) const {
  int places = 0;
  std::size_t bytes = 0;
  for (const Waiter& waiter : waiters_) {
    if (!waiter.is_in) continue;
    ++places;
    bytes += waiter.making.bytes;
  }
  return places == 0 || (places < limits_.places && bytes + making.bytes <= limits_.bytes);
}

void RenderLimiter::let_in() {
  for (Waiter& waiter : waiters_) {
    if (waiter.is_in || is_held_up(waiter.making)) continue;
    if (!fits(waiter.making)) break;  // nobody overtakes it, or it might wait for ever
    waiter.is_in = true;
  }
  let_in_.notify_all();
}

void RenderLimiter::leave(Waiters_::iterator waiter) {
  const std::lock_guard lock(mutex_);
  waiters_.erase(waiter);
  let_in();
}

}  // namespace unwrapd::server::results
