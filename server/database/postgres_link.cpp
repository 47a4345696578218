#include "server/database/postgres_link.hpp"

#include <array>
#include <cctype>
#include <cstring>
#include <system_error>

#include "core/base/error.hpp"
#include "core/base/parse_number.hpp"
#include "server/base/errors.hpp"
#include "server/base/files.hpp"
#include "server/database/numbered_places.hpp"
#include "server/database/postgres_url.hpp"

namespace unwrapd::server::database {
namespace {

/// The session writes in transactions alone, which say so: a change outside of one, which would not
/// be healed, is an error. A commit is on the disk before it is answered. The server finds out in
/// some seconds, too, that a link is cut: until then the old session has its locks.
constexpr const char* kSession =
    "SET default_transaction_read_only = on; SET synchronous_commit = on;"
    " SET idle_in_transaction_session_timeout = '30s'; SET client_min_messages = error;"
    " SET tcp_keepalives_idle = 5; SET tcp_keepalives_interval = 2; SET tcp_keepalives_count = 3;"
    " SET tcp_user_timeout = '10s'";

constexpr int kOldestVersion = 150000;  // as libpq says 15.0

std::string line_of(const char* message) {
  std::string line(message);
  while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0)
    line.pop_back();
  for (char& c : line)
    if (c == '\n') c = ' ';
  return line;
}

/// Whether the state says that the server ends, begins, or has no room for another session.
bool is_away(std::string_view state) {
  for (const std::string_view way : {"57P01", "57P02", "57P03", "53300"})
    if (state == way) return true;
  return state.starts_with("08");
}

}  // namespace

std::int64_t number_in(std::string_view text) {
  if (text.empty()) return 0;
  if (const auto number = parse_number<std::int64_t>(text)) return *number;
  throw InsideError(
      ErrorCode::storage_failed, "The server's store failed; try again later.",
      "The database of --database has " + std::string(text) + " where a whole number belongs.");
}

int PostgresResult::changed() const {
  return static_cast<int>(number_in(LibpqLibrary::loaded().cmd_tuples(get())));
}

std::string PostgresResult::text(int row, int column) const {
  const LibpqLibrary& pq = LibpqLibrary::loaded();
  const auto size = static_cast<std::size_t>(pq.length(get(), row, column));
  return {pq.value(get(), row, column), size};
}

/// What stands before the URL is a default of ours, which it may set otherwise.
PostgresLink::PostgresLink(const std::string& url) {
  check_url(url);
  const auto keywords =
      std::to_array<const char*>({"connect_timeout", "tcp_user_timeout", "keepalives_idle",
                                  "keepalives_interval", "keepalives_count", "target_session_attrs",
                                  "application_name", "dbname", "client_encoding", nullptr});
  const auto values = std::to_array<const char*>(
      {"5", "10000", "5", "2", "3", "read-write", "unwrapd", url.c_str(), "UTF8", nullptr});
  static_assert(keywords.size() == values.size());
  session_.reset(pq_.connect(keywords.data(), values.data(), 1));
  if (session_ == nullptr) throw LinkLost{"out of memory"};
  if (pq_.status(session_.get()) != CONNECTION_OK)
    throw LinkLost{without_pieces_of_url(line_of(pq_.error_message(session_.get())))};
  const char* encoding = pq_.parameter_status(session_.get(), "server_encoding");
  if (encoding == nullptr || std::strcmp(encoding, "UTF8") != 0)
    throw InsideError(ErrorCode::storage_failed, "The server's store failed.",
                      "The database of --database is not in UTF8; make one by createdb -E UTF8 -T "
                      "template0.");
  if (pq_.server_version(session_.get()) < kOldestVersion)
    throw InsideError(ErrorCode::storage_failed, "The server's store failed.",
                      "The PostgreSQL server of --database is older than version 15.");
  run(kSession);
}

void PostgresLink::fail(const PostgresResult& result) {
  const char* field =
      result.get() == nullptr ? nullptr : pq_.result_error_field(result.get(), PG_DIAG_SQLSTATE);
  const std::string_view state = field == nullptr ? "" : field;
  const std::string reason = line_of(pq_.error_message(session_.get()));
  if (pq_.status(session_.get()) != CONNECTION_OK || is_away(state)) throw LinkLost{reason};
  if (state == "53100") throw Error(ErrorCode::storage_full, std::string(kStorageFull));
  throw InsideError(ErrorCode::storage_failed, "The server's store failed; try again later.",
                    "The database of --database failed (" + reason + ").");
}

PostgresResult PostgresLink::checked(PGresult* got) {
  PostgresResult result(got);
  const ExecStatusType status = pq_.result_status(got);
  if (status != PGRES_COMMAND_OK && status != PGRES_TUPLES_OK) fail(result);
  return result;
}

PostgresResult PostgresLink::run(const std::string& sql) {
  return checked(pq_.exec(session_.get(), sql.c_str()));
}

std::vector<std::string> PostgresLink::notifications() {
  if (pq_.consume_input(session_.get()) == 0)
    throw LinkLost{line_of(pq_.error_message(session_.get()))};
  std::vector<std::string> payloads;
  while (PGnotify* note = pq_.notifies(session_.get())) {
    payloads.emplace_back(note->extra);
    pq_.free_text(note);
  }
  return payloads;
}

const std::string& PostgresLink::prepared(const std::string& sql, const std::vector<Oid>& types) {
  const auto known = prepared_.find(sql);
  if (known != prepared_.end()) return known->second;
  const std::string name = "s" + std::to_string(prepared_.size());
  const std::string text = with_dollars(sql);
  checked(pq_.prepare(session_.get(), name.c_str(), text.c_str(), static_cast<int>(types.size()),
                      types.data()));
  return prepared_.emplace(sql, name).first->second;
}

PostgresResult PostgresLink::run(const std::string& sql, const std::vector<BoundValue>& values) {
  std::vector<Oid> types;
  std::vector<const char*> texts;
  for (const BoundValue& value : values) {
    types.push_back(value.type);
    texts.push_back(value.text.c_str());
  }
  const std::string& name = prepared(sql, types);
  return checked(pq_.exec_prepared(session_.get(), name.c_str(), static_cast<int>(texts.size()),
                                   texts.data(), nullptr, nullptr, 0));
}

}  // namespace unwrapd::server::database
