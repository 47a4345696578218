#include "server/access/key_store.hpp"

#include <openssl/crypto.h>

#include <algorithm>
#include <cctype>

#include "core/base/error.hpp"
#include "server/base/clock.hpp"
#include "server/base/files.hpp"
#include "server/base/identity.hpp"
#include "server/database/schema.hpp"

namespace unwrapd::server::access {
namespace {

constexpr std::string_view kPrefix = "unw_";
constexpr std::size_t kIdDigits = 16;
constexpr std::size_t kSecretDigits = 64;
constexpr std::string_view kSpace = " \t\r\n";
constexpr std::string_view kSigns = "-._~+/=";  // of keys, beside letters and digits
constexpr std::size_t kMinGiven = 32;
constexpr std::size_t kMaxGiven = 512;
constexpr const char* kSchema = R"sql(
CREATE TABLE IF NOT EXISTS keys (
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  name TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  scopes TEXT NOT NULL,
  requests_per_minute INTEGER NOT NULL,
  max_jobs INTEGER NOT NULL,
  max_bytes INTEGER NOT NULL,
  created_ms INTEGER NOT NULL
) STRICT;
)sql";
constexpr std::string_view kSelect =
    "SELECT id, name, scopes, requests_per_minute, max_jobs, max_bytes, created_ms, sha256"
    " FROM keys ";
constexpr int kDigestColumn = 7;

std::shared_ptr<database::Database> opened(const std::filesystem::path& data,
                                           const database::PostgresAddress& database,
                                           KeyStore::Tables tables) {
  if (!database.url.empty()) {
    auto all = database::DatabaseAddress(database).open();
    if (tables == KeyStore::Tables::existing) {
      database::require_current(*all);
    } else {
      database::migrate(*all);
    }
    return all;
  }
  make_directories(data);
  auto keys = database::DatabaseAddress(data / kKeysFile).open();
  keys->check(false);
  keys->run(kSchema);
  return keys;
}

ApiKey key_of(const database::Statement& row) {
  return {.id = row.text(0),
          .name = row.text(1),
          .scopes = parse_scopes(row.text(2)),
          .requests_per_minute = row.number(3),
          .quota = {.max_jobs = row.number(4), .max_bytes = row.number(5)},
          .created_ms = row.number(6),
          .sha256 = row.text(kDigestColumn)};
}

bool same(const std::string& left, const std::string& right) {
  return left.size() == right.size() &&
         CRYPTO_memcmp(left.data(), right.data(), left.size()) == 0;  // in constant time
}

std::string_view without_space(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  return text.substr(0, text.find_last_not_of(kSpace) + 1);
}

std::string read_given(const std::filesystem::path& file) {
  try {
    return read_file(file);
  } catch (const Error& error) {
    throw Error(error.code(), "The file " + file.string() + " of --key-file: " + error.what());
  }
}

/// The key in the file, if it has the characters of RFC 6750 and is too long to be guessed.
std::string key_in(const std::filesystem::path& file) {
  const std::string given = read_given(file);
  const std::string text(without_space(given));
  const bool of_form = std::ranges::all_of(text, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           kSigns.find(c) != std::string_view::npos;
  });
  if (of_form && text.size() >= kMinGiven && text.size() <= kMaxGiven) return text;
  throw Error(ErrorCode::invalid_option,
              "The file of --key-file contains no key of 32 to 512 letters, digits and -._~+/=; "
              "make one with openssl rand -hex 32.");
}

ApiKey given_key(const std::string& digest) {
  ApiKey key;
  key.id = kGivenKeyId;
  key.name = "that of --key-file";
  key.scopes.admin = true;
  key.sha256 = digest;
  return key;
}

void check_name(const std::string& name) {
  const auto is_control = [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; };
  if (std::ranges::none_of(name, is_control)) return;
  throw Error(ErrorCode::invalid_option,
              "The name of a key has control characters; use letters, digits and signs.");
}

void set_scope(Scopes& scopes, std::string_view name) {
  if (name == "submit") {
    scopes.submit = true;
  } else if (name == "read") {
    scopes.read = true;
  } else if (name == "admin") {
    scopes.admin = true;
  } else {
    throw Error(ErrorCode::invalid_option,
                "There is no scope \"" + std::string(name) + "\"; use submit, read or admin.");
  }
}

}  // namespace

Scopes parse_scopes(std::string_view text) {
  Scopes scopes;
  while (true) {
    const std::size_t comma = text.find(',');
    set_scope(scopes, without_space(text.substr(0, comma)));
    if (comma == std::string_view::npos) return scopes;
    text.remove_prefix(comma + 1);
  }
}

std::string to_text(const Scopes& scopes) {
  std::string text;
  const auto add = [&](bool has, std::string_view name) {
    if (has) text += (text.empty() ? "" : ",") + std::string(name);
  };
  add(scopes.submit, "submit");
  add(scopes.read, "read");
  add(scopes.admin, "admin");
  return text;
}

KeyStore::KeyStore(const std::filesystem::path& data, const std::filesystem::path& given,
                   const database::PostgresAddress& database, Tables tables)
    : database_(opened(data, database, tables)),
      given_(given.empty() ? "" : sha256(key_in(given))),
      is_shared_(!database.url.empty()) {}

KeyStore::KeyStore(const database::DatabaseAddress& database, const std::filesystem::path& given)
    : database_(database.open()),
      given_(given.empty() ? "" : sha256(key_in(given))),
      is_shared_(true) {}

std::string KeyStore::add(ApiKey key) {
  check_name(key.name);
  const std::string digits = random_hex(kIdDigits / 2);
  const std::string text = std::string(kPrefix) + digits + "_" + random_hex(kSecretDigits / 2);
  const std::lock_guard lock(mutex_);
  database_->change([&] {
    database::Statement(
        *database_,
        "INSERT INTO keys (id, name, sha256, scopes, requests_per_minute, max_jobs, max_bytes,"
        " created_ms) VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
        .with("k_" + digits, key.name, sha256(text), to_text(key.scopes), key.requests_per_minute,
              key.quota.max_jobs, key.quota.max_bytes, now_ms())
        .run();
  });
  return text;
}

std::optional<ApiKey> KeyStore::find(std::string_view text) {
  if (!given_.empty() && same(given_, sha256(text))) return given_key(given_);
  const bool of_form =
      text.starts_with(kPrefix) && text.size() == kPrefix.size() + kIdDigits + 1 + kSecretDigits;
  if (!of_form) return std::nullopt;
  const std::string id = "k_" + std::string(text.substr(kPrefix.size(), kIdDigits));
  const std::lock_guard lock(mutex_);
  database::Statement statement(*database_, std::string(kSelect) + "WHERE id = ?");
  if (!statement.with(id).step()) return std::nullopt;
  if (!same(statement.text(kDigestColumn), sha256(text))) return std::nullopt;
  return key_of(statement);
}

bool KeyStore::has_any() { return !given_.empty() || !all().empty(); }

std::optional<ApiKey> KeyStore::with_id(std::string_view id) {
  if (!given_.empty() && id == kGivenKeyId) return given_key(given_);
  const std::lock_guard lock(mutex_);
  database::Statement statement(*database_, std::string(kSelect) + "WHERE id = ?");
  if (!statement.with(id).step()) return std::nullopt;
  return key_of(statement);
}

std::vector<ApiKey> KeyStore::all() {
  const std::lock_guard lock(mutex_);
  database::Statement statement(*database_, std::string(kSelect) + "ORDER BY seq");
  std::vector<ApiKey> keys;
  while (statement.step()) keys.push_back(key_of(statement));
  return keys;
}

int KeyStore::wait_seconds(const ApiKey& key, double cost) {
  const std::int64_t most = key.requests_per_minute;
  if (most == 0) return 0;
  if (!is_shared_) return rates_.wait_seconds(key.id, most, RateLimit::Clock::now(), cost);
  const std::lock_guard lock(mutex_);
  return wait_seconds_of_all(*database_, key.id, most, std::min(cost, static_cast<double>(most)));
}

bool KeyStore::remove(std::string_view id) {
  const std::lock_guard lock(mutex_);
  return database_->change([&] {
    database::Statement(*database_, "DELETE FROM keys WHERE id = ?").with(id).run();
    return database_->changes() == 1;
  });
}

}  // namespace unwrapd::server::access
