#pragma once
// Decides which clients may enter a full queue, and when a rejected client should come back. A
// rejected client is promised a slot, and that slot is reserved: a newcomer is accepted only if all
// promised clients still find their slots, or if no job waits. Without the second rule, workers
// would idle for a client that never returns. The length and spread of past jobs tell when slots
// become free.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server::jobs {

/// A client that asks for a slot.
struct Applicant {
  std::string_view who;         ///< tells it from other clients
  std::string_view owner = {};  ///< its API key; keys take turns
};

/// The state of a queue and how fast it moves. Times in seconds.
struct QueueForecast {
  std::int64_t places = 1;
  std::int64_t waiting = 0;  ///< places taken
  double first = 0;          ///< until the first of them becomes free
  double interval = 1;       ///< and from then on each next one; > 0
  double spread = 0;         ///< of an interval: how far it is off, in the mean
};

/// The mean length of recent jobs, and their mean deviation from it.
struct Lengths {
  static constexpr int kRemembered = 50;  ///< jobs that the mean is of, about

  double mean = 1;
  double spread = 0;
  int count = 0;  ///< of jobs, up to what still matters

  void add(double seconds);
};

/// The forecast of a queue before workers. ran: for each running job, the seconds since it began.
/// Its remaining time is not known: it is assumed to run as long as others did, and at least half
/// as long again as it has run.
QueueForecast forecast_queue(std::int64_t places, std::int64_t waiting, int workers,
                             const Lengths& lengths, std::span<const double> ran);

/// Not for use by two threads at once.
class SlotReservations {
 public:
  using Clock = std::chrono::steady_clock;

  /// Returns nothing if the client may enter: its slot is reserved for half a minute, in which it
  /// sends its job, or until leave(). Else returns the seconds, at least 1, after which it should
  /// come back. A client that was promised a slot and comes in time finds it if the queue moved as
  /// forecast; if not, it is the next. An owner's further promises rank behind the first promise of
  /// each other owner.
  std::optional<int> ask(Clock::time_point now, const Applicant& applicant,
                         const QueueForecast& line);
  /// Ends the reservation of a client that has entered for good, or given up.
  void leave(std::string_view who);

  [[nodiscard]] bool empty() const { return promises_.empty(); }

 private:
  struct Promise {
    std::string who;
    std::string owner;
    Clock::time_point due;
    Clock::time_point until;
    bool inside = false;  ///< the client came, and sends its job
    bool again = false;   ///< the client was promised one before, and found none
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
