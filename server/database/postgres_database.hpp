#pragma once
// PostgreSQL behind the interface of database.hpp. A session that is lost (a restart, a failover, a
// cut link) is made again, within the patience of the address: what was being read is read again,
// and what was being changed is changed again unless it is found done. To find that, each
// transaction writes its number into the row of this connection in the table `writers`; one whose
// answer to COMMIT was lost is there or not. Where nobody answers in time, StoreAway tells clients
// to come back. Further calls fail at once, but for one in a while that tries: at most a tenth of
// the time goes into tries, of which each may take connect_timeout a host where packets are lost.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "server/database/database.hpp"
#include "server/database/postgres_address.hpp"
#include "server/database/postgres_link.hpp"

namespace unwrapd::server::database {

/// Thread-safe.
class PostgresDatabase final : public Database {
 public:
  /// Throws InsideError{storage_failed} when it cannot be reached. The first change makes its own
  /// tables where they are missing.
  explicit PostgresDatabase(PostgresAddress address);

  void run(const std::string& sql) override;
  [[nodiscard]] std::unique_ptr<Cursor> prepare(std::string_view sql) const override;
  [[nodiscard]] int changes() const override { return changes_; }
  [[nodiscard]] const Dialect& dialect() const override;
  [[nodiscard]] std::int64_t version() const override;
  [[nodiscard]] std::string step_to(std::int64_t version) const override;
  void set_version(std::int64_t version) override;
  void lock_version() override;
  /// It checks its pages as it reads them, where checksums are on; damage is an error then.
  void check(bool /*indices*/) const override {}
  void check_reachable() const override;
  /// Holds advisory locks for as long as this exists, and takes them again after a loss: alone, or
  /// beside the nodes of the same store.
  void claim() override;
  [[nodiscard]] bool was_away() override {
    const std::scoped_lock lock(mutex_);
    return std::exchange(was_away_, false);
  }

  /// Runs a prepared statement.
  [[nodiscard]] PostgresResult execute(const std::string& sql,
                                       const std::vector<BoundValue>& values) const;

 private:
  using Clock = std::chrono::steady_clock;
  using Attempt = std::function<void(PostgresLink& link)>;

  void apply_all(Extent extent, const std::function<void()>& make) override;
  void attempt(std::int64_t number, const std::function<void()>& make, bool& in_doubt);
  void roll_back() noexcept;
  [[noreturn]] void fail(bool in_doubt) const;
  void make_tables();
  void patiently(const Attempt& attempt) const;
  PostgresLink& link() const;
  void link_until(Clock::time_point end, bool in_doubt) const;
  void try_link() const;
  void claim_on(PostgresLink& link) const;
  void lose_link(const LinkLost& lost, Clock::time_point& end, bool in_doubt) const;
  [[noreturn]] void be_away(bool in_doubt) const;

  mutable std::recursive_mutex mutex_;  ///< of a call; of a change until its end
  const PostgresAddress address_;
  const std::string writer_;  // the id of this connection's row
  std::int64_t number_ = 0;   // of the last transaction
  bool claimed_ = false;
  bool has_own_tables_ = false;
  bool in_transaction_ = false;
  mutable std::unique_ptr<PostgresLink> link_;
  mutable std::string session_;  // that of the link, or of the one before
  mutable std::string why_away_;
  mutable bool was_away_ = false;
  mutable Clock::time_point next_try_{};
  mutable int changes_ = 0;
};

}  // namespace unwrapd::server::database
