#pragma once
// How nodes of one PostgreSQL database tell each other of events: rows, and hints by NOTIFY that
// there is something to look at. Neither is needed for a job to be done: rows are in a table that
// is empty after a crash of PostgreSQL, and hints may be lost. So its changes do not wait for the
// disk, and hints are sent outside of the transactions of jobs, whose commits a NOTIFY would make
// wait for each other.

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/wakeup.hpp"
#include "server/database/postgres_address.hpp"
#include "server/database/postgres_link.hpp"

namespace unwrapd::server::store {

/// An event of a job as other nodes are told of it.
struct EventRow {
  std::string job;
  std::int64_t seq = 0;
  bool is_last = false;
  std::string frame;     ///< as it is sent to readers
  std::string progress;  ///< JSON of api::JobProgress; empty: as before
};

/// One session. Not for use by two threads at once. Throws LinkLost when it has ended, else
/// InsideError{storage_failed}.
class EventChannel {
 public:
  using JobAndSeq = std::pair<std::string, std::int64_t>;

  explicit EventChannel(const database::PostgresAddress& address);

  /// Events of one job must come in their order. A number that is there already stays as it is.
  void append(const std::vector<EventRow>& events);
  /// The events of these jobs after these numbers, in order.
  std::vector<EventRow> after(const std::vector<JobAndSeq>& jobs);
  /// Of these jobs, those that have ended, or are gone.
  std::vector<std::string> ended(const std::vector<JobAndSeq>& jobs);
  /// Removes the events of jobs that ended before this time, or are gone.
  void forget_before(std::int64_t finished_ms);

  void hint(std::string_view text);
  /// From now on, hints of all nodes arrive.
  void listen();
  /// Waits for hints until the time is over or somebody rings.
  std::vector<std::string> wait(std::chrono::milliseconds time, const Wakeup& bell);

 private:
  database::PostgresLink link_;
  std::string channel_;
};

}  // namespace unwrapd::server::store
