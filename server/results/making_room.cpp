#include "server/results/making_room.hpp"

#include <algorithm>

#include "server/base/retry_later.hpp"

namespace unwrapd::server {
namespace {

constexpr int kMakingRetrySeconds = 5;

int half_of(int count) { return std::max(1, count / 2); }

}  // namespace

Error client_left() {
  return {ErrorCode::cancelled,
          "The client closed its connection; send the request again and wait."};
}

std::shared_ptr<void> MakingRoom::enter(const Making& making, const HasLeft& has_left) {
  std::unique_lock lock(mutex_);
  check_waiting(making.holder);
  const auto self = guests_.insert(guests_.end(), {.making = making});
  let_in();
  try {
    await_place(lock, self->is_in, has_left);
  } catch (...) {
    guests_.erase(self);
    let_in();
    throw;
  }
  lock.unlock();
  return {nullptr, [this, self](void*) { leave(self); }};
}

void MakingRoom::await_place(std::unique_lock<std::mutex>& lock, const bool& is_in,
                             const HasLeft& has_left) {
  while (!let_in_.wait_for(lock, kPresenceLook, [&] { return is_in; }))
    if (has_left && has_left()) throw client_left();
}

int MakingRoom::waiting() {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(std::ranges::count(guests_, false, &Guest::is_in));
}

void MakingRoom::check_waiting(const std::string& holder) const {
  const auto waits_for_holder = [&](const Guest& guest) {
    return !guest.is_in && guest.making.holder == holder;
  };
  if (std::ranges::count(guests_, false, &Guest::is_in) < limits_.waiting &&
      std::ranges::count_if(guests_, waits_for_holder) < half_of(limits_.waiting))
    return;
  throw RetryLater(ErrorCode::rate_limited,
                   "Too many requests wait for pictures and formats; try again after Retry-After.",
                   kMakingRetrySeconds);
}

/// Whether it waits for its like, so that who came later need not wait for it.
bool MakingRoom::is_held_up(const Making& making) const {
  const auto same_file = [&](const Guest& guest) {
    return guest.is_in && guest.making.file == making.file;
  };
  const auto same_holder = [&](const Guest& guest) {
    return guest.is_in && guest.making.holder == making.holder;
  };
  const auto costly = [](const Guest& guest) { return guest.is_in && guest.making.is_costly; };
  return std::ranges::any_of(guests_, same_file) ||
         (making.is_costly && std::ranges::any_of(guests_, costly)) ||
         std::ranges::count_if(guests_, same_holder) >= half_of(limits_.places);
}

bool MakingRoom::fits(const Making& making) const {
  int places = 0;
  std::size_t bytes = 0;
  for (const Guest& guest : guests_) {
    if (!guest.is_in) continue;
    ++places;
    bytes += guest.making.bytes;
  }
  return places == 0 || (places < limits_.places && bytes + making.bytes <= limits_.bytes);
}

void MakingRoom::let_in() {
  for (Guest& guest : guests_) {
    if (guest.is_in || is_held_up(guest.making)) continue;
    if (!fits(guest.making)) break;  // nobody overtakes it, or it might wait for ever
    guest.is_in = true;
  }
  let_in_.notify_all();
}

void MakingRoom::leave(Guests::iterator guest) {
  const std::lock_guard lock(mutex_);
  guests_.erase(guest);
  let_in();
}

}  // namespace unwrapd::server
