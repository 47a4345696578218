#pragma once
// One session of PostgreSQL, by libpq: statements are prepared once, and what a failure means is
// decided here.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/database/libpq_library.hpp"

namespace unwrapd::server::database {

/// The session is gone, and with it what it has not committed. Of a COMMIT it leaves open whether
/// it came about. No std::exception, so that nobody takes it for an error of a row.
struct LinkLost {
  std::string reason;
};

/// A value of a statement, and its type.
struct BoundValue {
  std::string text;
  Oid type = 0;
};
inline constexpr Oid kTextType = 25;
inline constexpr Oid kNumberType = 20;

/// The number that PostgreSQL tells; 0 for NULL. Throws InsideError{storage_failed} when it is
/// none.
std::int64_t number_in(std::string_view text);

/// Rows, or the count of rows that were changed.
class PostgresResult {
 public:
  explicit PostgresResult(PGresult* result) : result_(result) {}

  [[nodiscard]] PGresult* get() const { return result_.get(); }
  [[nodiscard]] int rows() const { return LibpqLibrary::loaded().row_count(get()); }
  [[nodiscard]] int changed() const;
  [[nodiscard]] std::string text(int row, int column) const;

 private:
  struct Clear {
    void operator()(PGresult* result) const { LibpqLibrary::loaded().clear(result); }
  };
  std::unique_ptr<PGresult, Clear> result_;
};

/// Not for use by two threads at once. Throws LinkLost when the session has ended, else
/// InsideError{storage_failed} and Error{storage_full}.
class PostgresLink {
 public:
  /// Waits for the server for some seconds. url: its password is told to nobody.
  explicit PostgresLink(const std::string& url);

  PostgresResult run(const std::string& sql);
  PostgresResult run(const std::string& sql, const std::vector<BoundValue>& values);
  /// The socket of the session, on which notifications arrive.
  [[nodiscard]] int socket() const { return pq_.socket(session_.get()); }
  /// The payloads of notifications that have arrived.
  std::vector<std::string> notifications();

 private:
  struct Finish {
    void operator()(PGconn* session) const { LibpqLibrary::loaded().finish(session); }
  };
  PostgresResult checked(PGresult* result);
  [[noreturn]] void fail(const PostgresResult& result);
  const std::string& prepared(const std::string& sql, const std::vector<Oid>& types);

  const LibpqLibrary& pq_ = LibpqLibrary::loaded();
  std::unique_ptr<PGconn, Finish> session_;
  std::map<std::string, std::string> prepared_;  // SQL -> name
};

}  // namespace unwrapd::server::database
