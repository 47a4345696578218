#pragma once
// Who may come into a queue, and when those who may not are to come back. Whoever is turned away is
// promised a place, and that place is kept: a newcomer is let in only where all who were promised
// one still find theirs, or where nobody waits, lest workers wait for who never comes back. When
// places become free is told from how long jobs take, and how much they differ.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server::jobs {

/// Who asks for a place.
struct Applicant {
  std::string_view who;         ///< whatever tells him from others
  std::string_view owner = {};  ///< the key that he has; keys take turns
};

/// A queue as seen from its door. Times in seconds.
struct QueueForecast {
  std::int64_t places = 1;
  std::int64_t waiting = 0;  ///< places taken
  double first = 0;          ///< until the first of them becomes free
  double interval = 1;       ///< and from then on each next one; > 0
  double spread = 0;         ///< of an interval: how far it is off, in the mean
};

/// How long jobs took, of late: the mean, and how far they were off it.
struct Lengths {
  double mean = 1;
  double spread = 0;
  int count = 0;  ///< of jobs, up to what still matters

  void add(double seconds);
};

/// The line before workers, of whose running jobs `ran` tells how long each runs already. How long
/// they still take is not known: as long as others did, but at least half as long as they have.
QueueForecast forecast_queue(std::int64_t places, std::int64_t waiting, int workers,
                             const Lengths& lengths, std::span<const double> ran);

/// Not for use by two threads at once.
class SlotReservations {
 public:
  using Clock = std::chrono::steady_clock;

  /// A place for who asks, when this is nothing: it is kept for the
  /// half minute in which he sends what he has to send, or until leave(). Else he is to come back
  /// after this many seconds, at least 1. Who was promised a place and comes in time finds it where
  /// the line went on as told; if not, he is the next. All that an owner was promised stands back
  /// behind the first of each other owner.
  std::optional<int> ask(Clock::time_point now, const Applicant& applicant,
                         const QueueForecast& line);
  /// The place that `who` was given is his no longer: taken for good, or given up.
  void leave(std::string_view who);

  [[nodiscard]] bool empty() const { return promises_.empty(); }

 private:
  struct Promise {
    std::string who;
    std::string owner;
    Clock::time_point due;
    Clock::time_point until;
    bool inside = false;  ///< he came, and sends
    bool again = false;   ///< he was promised one before, and found none
  };
  using Promises = std::vector<Promise>;

  void forget(Clock::time_point now);
  [[nodiscard]] Promises::iterator due_to(Clock::time_point now, std::string_view who);
  [[nodiscard]] std::vector<const Promise*> before(std::string_view owner) const;
  [[nodiscard]] bool newcomer_fits(Clock::time_point now, const Applicant& applicant,
                                   const QueueForecast& line) const;
  int promise(Clock::time_point now, const Applicant& applicant, const QueueForecast& line,
              bool again);
  void keep(Promise promise);

  Promises promises_;  // by due, the earliest first
};

}  // namespace unwrapd::server::jobs
