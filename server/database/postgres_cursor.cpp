#include "server/database/postgres_cursor.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "api/json.hpp"
#include "server/base/utf8.hpp"

namespace unwrapd::server::database {
namespace {

/// PostgreSQL has neither NUL nor what is not UTF-8.
std::string as_text(std::string_view bytes) {
  std::string text(bytes);
  if (is_utf8_text(text) && text.find('\0') == std::string::npos) return text;
  for (char& c : text)
    if (c == '\0') c = '\xff';
  const api::Json json(std::move(text));
  return api::Json::parse(api::to_text(json));
}

/// All rows are there after the first step.
class PostgresCursor final : public Cursor {
 public:
  PostgresCursor(const PostgresDatabase& database, std::string_view sql)
      : database_(database), sql_(sql) {}

  void bind(int position, std::string_view text) override {
    value_at(position) = {.text = as_text(text), .type = kTextType};
  }
  void bind(int position, std::int64_t number) override {
    value_at(position) = {.text = std::to_string(number), .type = kNumberType};
  }

  bool step() override {
    if (!rows_) rows_ = database_.execute(sql_, values_);
    return ++row_ < rows_->rows();
  }

  [[nodiscard]] std::int64_t number(int column) const override {
    return number_in(rows_->text(row_, column));
  }

  [[nodiscard]] std::string text(int column) const override { return rows_->text(row_, column); }

 private:
  BoundValue& value_at(int position) {
    const auto count = static_cast<std::size_t>(position);
    if (values_.size() < count) values_.resize(count, {.text = "", .type = kTextType});
    return values_[count - 1];
  }

  const PostgresDatabase& database_;
  const std::string sql_;
  std::vector<BoundValue> values_;
  std::optional<PostgresResult> rows_;
  int row_ = -1;
};

}  // namespace

std::unique_ptr<Cursor> postgres_cursor(const PostgresDatabase& database, std::string_view sql) {
  return std::make_unique<PostgresCursor>(database, sql);
}

}  // namespace unwrapd::server::database
