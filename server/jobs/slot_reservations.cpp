#include "server/jobs/slot_reservations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace unwrapd::server::jobs {
namespace {

using Clock = SlotReservations::Clock;
using Seconds = std::chrono::duration<double>;

constexpr std::chrono::seconds kLate{2};      // how late a promised client may come
constexpr std::chrono::seconds kSending{30};  // how long a slot is reserved for an upload
constexpr double kMargin = 3;                 // spreads by which the queue may be late
constexpr double kShortestMean = 1e-3;        // seconds of a job
constexpr std::int64_t kFewestPromises = 64;  // that are kept at a time at most, in a short queue

double seconds_until(Clock::time_point due, Clock::time_point now) {
  return std::max(0.0, Seconds(due - now).count());
}

/// Simulates how the queue moves, by the mean length of jobs.
class Moving {
 public:
  explicit Moving(const QueueForecast& line)
      : line_(line), inside_(line.waiting), next_(line.first) {}

  /// Adds a client `seconds` from now, and not before the earlier ones. False when there is no slot
  /// then, if the queue is a little slow.
  bool come_in(double seconds) {
    move_to(std::max(0.0, seconds - margin()));
    ++came_;
    return ++inside_ <= line_.places;
  }

  /// Seconds until one more client finds a slot, if the queue is a little slow.
  [[nodiscard]] double next_place() const {
    const auto too_many = static_cast<double>(inside_ - line_.places);
    return too_many < 0 ? 0 : next_ + too_many * line_.interval + margin();
  }

 private:
  void move_to(double seconds) {
    for (; inside_ > 0 && next_ <= seconds; next_ += line_.interval) --inside_;
    if (inside_ == 0) next_ = std::max(next_, seconds);
  }

  /// Seconds by which the slot of one more client may become free late: the squares of deviations
  /// add up.
  [[nodiscard]] double margin() const {
    const auto to_leave = static_cast<double>(line_.waiting + came_ + 1 - line_.places);
    return kMargin * line_.spread * std::sqrt(std::max(0.0, to_leave));
  }

  const QueueForecast& line_;
  std::int64_t inside_;
  std::int64_t came_ = 0;
  double next_;
};

}  // namespace

void Lengths::add(double seconds) {
  count = std::min(count + 1, kRemembered);
  const double off = seconds - mean;
  mean += off / count;
  spread += (std::abs(off) - spread) / count;
}

QueueForecast forecast_queue(std::int64_t places, std::int64_t waiting, int workers,
                             const Lengths& lengths, std::span<const double> ran) {
  const double mean = std::max(lengths.mean, kShortestMean);
  const int idle = std::max(0, workers - static_cast<int>(ran.size()));
  QueueForecast line{.places = places, .waiting = waiting};
  line.first = idle > 0 ? 0 : std::numeric_limits<double>::infinity();
  double rate = idle / mean;
  for (const double seconds : ran) {
    line.first = std::min(line.first, std::max(mean - seconds, seconds / 2));
    rate += 1 / std::max(mean, seconds);
  }
  line.interval = 1 / rate;
  line.spread = lengths.spread / std::max(1, workers);
  return line;
}

std::optional<int> SlotReservations::ask(Clock::time_point now, const Applicant& applicant,
                                         const QueueForecast& line) {
  forget(now);
  const auto mine = due_to(now, applicant.who);
  if (mine == promises_.end()) {
    if (!newcomer_fits(now, applicant, line)) return promise(now, applicant, line, false);
  } else {
    const std::vector<const Promise*> counted = before(applicant.owner);
    const auto ahead = std::ranges::find(counted, &*mine) - counted.begin();
    const bool free = line.waiting + ahead < line.places;
    promises_.erase(mine);
    if (!free) return promise(now, applicant, line, true);
  }
  keep({.who = std::string(applicant.who),
        .owner = std::string(applicant.owner),
        .due = now,
        .until = now + kSending,
        .inside = true});
  return std::nullopt;
}

/// The promises that rank before a new one of this owner, by due time: its own, those of clients
/// that send already, and the first of each other owner.
std::vector<const SlotReservations::Promise*> SlotReservations::before(
    std::string_view owner) const {
  std::set<std::string_view> others;
  std::vector<const Promise*> found;
  for (const Promise& promise : promises_)
    if (promise.owner == owner || promise.inside || others.insert(promise.owner).second)
      found.push_back(&promise);
  return found;
}

void SlotReservations::leave(std::string_view who) {
  const auto is_of_client = [&](const Promise& promise) {
    return promise.inside && promise.who == who;
  };
  const auto found = std::ranges::find_if(promises_, is_of_client);
  if (found != promises_.end()) promises_.erase(found);
}

void SlotReservations::forget(Clock::time_point now) {
  std::erase_if(promises_, [&](const Promise& promise) { return promise.until < now; });
}

/// The slot of this client if it sends already, else its first promise that is due.
SlotReservations::Promises::iterator SlotReservations::due_to(Clock::time_point now,
                                                              std::string_view who) {
  const auto is_of_client = [&](const Promise& promise) {
    return promise.due <= now && promise.who == who;
  };
  return std::ranges::find_if(promises_, is_of_client);
}

bool SlotReservations::newcomer_fits(Clock::time_point now, const Applicant& applicant,
                                     const QueueForecast& line) const {
  if (line.waiting == 0 && std::ranges::count(promises_, true, &Promise::inside) == 0) return true;
  Moving moving(line);
  if (!moving.come_in(0)) return false;
  return std::ranges::all_of(before(applicant.owner), [&](const Promise* promise) {
    return moving.come_in(seconds_until(promise->due, now));
  });
}

/// again: the client was promised a slot before, so that only such clients are ahead of it.
int SlotReservations::promise(Clock::time_point now, const Applicant& applicant,
                              const QueueForecast& line, bool again) {
  Moving moving(line);
  double last = 0;
  for (const Promise* other : before(applicant.owner)) {
    if (again && !other->again) continue;
    last = seconds_until(other->due, now);
    moving.come_in(last);
  }
  const double wait = std::max({last, moving.next_place(), 1.0});
  const std::chrono::seconds whole(static_cast<std::int64_t>(std::ceil(wait)));
  const auto most = static_cast<std::size_t>(std::max(kFewestPromises, 4 * line.places));
  if (promises_.size() < most)
    keep({.who = std::string(applicant.who),
          .owner = std::string(applicant.owner),
          .due = now + whole,
          .until = now + whole + kLate,
          .again = again});
  return static_cast<int>(whole.count());
}

void SlotReservations::keep(Promise promise) {
  const auto place = std::ranges::upper_bound(promises_, promise.due, {}, &Promise::due);
  promises_.insert(place, std::move(promise));
}

}  // namespace unwrapd::server::jobs
