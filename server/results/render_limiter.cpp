#include "server/results/render_limiter.hpp"

#include <algorithm>
#include <utility>

#include "server/base/errors.hpp"

namespace unwrapd::server::results {
namespace {

constexpr int kMakingRetrySeconds = 5;

}  // namespace

Error client_left() {
  return {ErrorCode::cancelled,
          "The client closed its connection; send the request again and wait."};
}

std::shared_ptr<void> RenderLimiter::enter(const RenderRequest& request,
                                           const http::HasLeft& has_left) {
  std::unique_lock lock(mutex_);
  ConcurrencyLimit::Place to_wait = place_to_wait(request.holder);
  const auto self =
      visitors_.insert(visitors_.end(), {.request = request, .to_wait = std::move(to_wait)});
  let_in();
  try {
    await_place(lock, *self, has_left);
  } catch (...) {
    visitors_.erase(self);
    let_in();
    throw;
  }
  lock.unlock();
  return {nullptr, [this, self](void*) { leave(self); }};
}

void RenderLimiter::await_place(std::unique_lock<std::mutex>& lock, const Visitor& visitor,
                                const http::HasLeft& has_left) {
  while (!let_in_.wait_for(lock, kPresenceLook, [&] { return visitor.to_make != nullptr; }))
    if (has_left && has_left()) throw client_left();
}

ConcurrencyLimit::Place RenderLimiter::place_to_wait(const std::string& holder) {
  if (ConcurrencyLimit::Place place = places_to_wait_.try_enter(holder)) return place;
  throw RetryLater(ErrorCode::rate_limited,
                   "Too many requests wait for pictures and formats; try again after Retry-After.",
                   kMakingRetrySeconds);
}

/// True when the request waits for another's end; later ones may overtake it meanwhile.
bool RenderLimiter::is_held_up(const RenderRequest& request) const {
  return std::ranges::any_of(visitors_, [&](const Visitor& other) {
    return other.to_make &&
           (other.request.file == request.file || (request.is_costly && other.request.is_costly));
  });
}

/// A file alone may take more than the limit.
bool RenderLimiter::fits_memory(const RenderRequest& request) const {
  std::size_t bytes = 0;
  for (const Visitor& visitor : visitors_)
    if (visitor.to_make) bytes += visitor.request.bytes;
  return places_.count() == 0 || bytes + request.bytes <= most_bytes_;
}

void RenderLimiter::let_in() {
  for (Visitor& visitor : visitors_) {
    if (visitor.to_make || is_held_up(visitor.request)) continue;
    const auto refusal = places_.refusal(visitor.request.holder);
    if (refusal == ConcurrencyLimit::Refusal::share) continue;
    // Later ones do not overtake it, or it might wait for ever.
    if (refusal == ConcurrencyLimit::Refusal::full || !fits_memory(visitor.request)) break;
    visitor.to_make = places_.try_enter(visitor.request.holder);
    visitor.to_wait.reset();
  }
  let_in_.notify_all();
}

void RenderLimiter::leave(Visitors::iterator visitor) {
  const std::lock_guard lock(mutex_);
  visitors_.erase(visitor);
  let_in();
}

}  // namespace unwrapd::server::results
