#pragma once
// Where rows are kept, behind one interface: a database with its transactions, a prepared
// statement. Nothing above it knows which engine there is. Every failure is
// InsideError{storage_failed}, whose message tells clients nothing of the engine, or
// Error{storage_full} when there is no room to write.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace unwrapd::server::database {

/// What engines call by different names in one SQL text.
struct Dialect {
  std::string_view least;             ///< the function for the smaller of two values
  std::string_view greatest;          ///< and the larger
  std::string_view skip_locked = "";  ///< ends a query that passes over rows others are changing
  bool has_index_hints = false;

  /// What follows the name of a table that is to be read by this index.
  [[nodiscard]] std::string by_index(std::string_view name) const {
    return has_index_hints ? " INDEXED BY " + std::string(name) : std::string();
  }
};

/// One engine's prepared statement; see Statement.
class Cursor {
 public:
  Cursor() = default;
  Cursor(const Cursor&) = delete;
  Cursor& operator=(const Cursor&) = delete;
  virtual ~Cursor() = default;

  virtual void bind(int position, std::string_view text) = 0;
  virtual void bind(int position, std::int64_t number) = 0;
  virtual bool step() = 0;
  [[nodiscard]] virtual std::int64_t number(int column) const = 0;
  [[nodiscard]] virtual std::string text(int column) const = 0;
};

/// How many statements a change consists of.
enum class Extent { one, several };

/// One connection, whose commits survive a loss of power. A file's is not for use by two threads at
/// once; with PostgreSQL calls of others wait for the end of a change.
class Database {
 public:
  Database() = default;
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  virtual ~Database() = default;

  /// Runs statements that return nothing.
  virtual void run(const std::string& sql) = 0;
  [[nodiscard]] virtual std::unique_ptr<Cursor> prepare(std::string_view sql) const = 0;
  /// Rows that the last INSERT, UPDATE or DELETE touched.
  [[nodiscard]] virtual int changes() const = 0;
  [[nodiscard]] virtual const Dialect& dialect() const = 0;

  /// The version of the tables, 0 before the first; and the statements that lead to each version
  /// from the one before. An empty step has nothing to do.
  [[nodiscard]] virtual std::int64_t version() const = 0;
  [[nodiscard]] virtual std::string step_to(std::int64_t version) const = 0;
  /// Notes it, within the transaction of the step.
  virtual void set_version(std::int64_t version) = 0;
  /// Keeps others from changing the version until the end of the transaction.
  virtual void lock_version() {}

  /// Throws when what it has stored is found damaged. indices: whether they say the same as the
  /// tables, too, which takes longer.
  virtual void check(bool indices) const = 0;
  /// Whether it was found damaged since it was opened. Thread-safe.
  [[nodiscard]] virtual bool is_damaged() const { return false; }

  /// Throws StoreAway when it cannot be reached now.
  virtual void check_reachable() const {}
  /// Whether a call has thrown StoreAway since this was asked last.
  [[nodiscard]] virtual bool was_away() { return false; }
  /// Keeps every other server out of this store while this exists; a file is locked elsewhere
  /// (DataLock). Throws InsideError{storage_failed} when another has done so.
  virtual void claim() {}

  /// Makes a change of one statement; returns what make() does. make() may be called again, when it
  /// is known that nothing of the first time remains.
  template <class Make>
  auto change(const Make& make) {
    return apply(Extent::one, make);
  }
  /// The same of several statements: all are made or, where something is thrown, none.
  template <class Make>
  auto transact(const Make& make) {
    return apply(Extent::several, make);
  }

 private:
  virtual void apply_all(Extent extent, const std::function<void()>& make) = 0;

  template <class Make>
  auto apply(Extent extent, const Make& make) {
    using Result = std::invoke_result_t<const Make&>;
    if constexpr (std::is_void_v<Result>) {
      apply_all(extent, make);
    } else {
      std::optional<Result> result;
      apply_all(extent, [&] { result.emplace(make()); });
      return std::move(*result);
    }
  }
};

/// A prepared statement, which must not outlive its database. Values are bound by position from 1;
/// columns are read from 0.
class Statement {
 public:
  Statement(const Database& database, std::string_view sql) : cursor_(database.prepare(sql)) {}

  void bind(int position, std::string_view text) { cursor_->bind(position, text); }
  void bind(int position, std::int64_t number) { cursor_->bind(position, number); }

  /// Binds all values in order, from position 1.
  template <class... Values>
  Statement& with(const Values&... values) {
    int position = 0;
    (bind(++position, values), ...);
    return *this;
  }

  /// True when there is a row to read, false at the end.
  bool step() { return cursor_->step(); }
  /// Runs to the end, ignoring rows.
  void run() {
    while (step()) {
    }
  }

  [[nodiscard]] std::int64_t number(int column) const { return cursor_->number(column); }
  [[nodiscard]] std::string text(int column) const { return cursor_->text(column); }

 private:
  std::unique_ptr<Cursor> cursor_;
};

/// What a query answers that has one row of one number.
inline std::int64_t number_of(const Database& database, std::string_view sql) {
  Statement statement(database, sql);
  statement.step();
  return statement.number(0);
}

}  // namespace unwrapd::server::database
