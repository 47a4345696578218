#pragma once
// API keys, in DIR/keys.sqlite: of their own, so that `unwrapd keys` may write it while the server
// runs, and a copy of the jobs holds no keys. With --database they are a table there. A key is
// "unw_<id>_<secret>" with 256 random bits of secret; only its SHA-256 is stored. A slow hash was
// rejected: it makes guessing hard where there are few passwords, and 2^256 secrets need no help.
// One more key may be given as a file, as containers are given secrets: it is not stored, and goes
// when the file does.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/access/rate_limit.hpp"
#include "server/database/database_address.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::access {

inline constexpr const char* kKeysFile = "keys.sqlite";
inline constexpr const char* kGivenKeyId = "k_file";

/// What a key may be used for.
struct Scopes {
  bool submit = false;  ///< send, cancel and remove jobs
  bool read = false;    ///< look at jobs and fetch results
  bool admin = false;   ///< both, and of all keys

  friend bool operator==(const Scopes&, const Scopes&) = default;
};

struct ApiKey {
  std::string id;    ///< "k_" and 16 hex digits: the owner of its jobs
  std::string name;  ///< for people
  Scopes scopes;
  std::int64_t requests_per_minute = 0;  ///< 0: no limit
  http::Quota quota;
  std::int64_t created_ms = 0;
  std::string sha256 = {};  ///< of its text
};

/// "submit,read", with or without spaces. Throws Error{invalid_option} when a name is none of
/// submit, read and admin.
Scopes parse_scopes(std::string_view text);
std::string to_text(const Scopes& scopes);

/// Thread-safe. Every function may throw Error{storage_failed, storage_full}.
class KeyStore {
 public:
  /// Of a database with a URL: made and migrated, or only used where this version's are there.
  enum class Tables { made, existing };

  /// data: the data directory. database: without a URL, a file there, made when missing. given: the
  /// file of a key of the operator's own, of the scope admin and the id kGivenKeyId; empty: none.
  /// Throws Error{invalid_option} when that holds no key: 32 to 512 letters, digits and -._~+/=,
  /// and white space around them.
  explicit KeyStore(const std::filesystem::path& data, const std::filesystem::path& given = {},
                    const database::PostgresAddress& database = {}, Tables tables = Tables::made);
  /// Of a database with a URL whose tables are there. given: as above.
  KeyStore(const database::DatabaseAddress& database, const std::filesystem::path& given);

  /// Stores a key with a new id and returns what its holder sends; it cannot be had again. Throws
  /// Error{invalid_option} for a name with control characters, which a list could not show.
  std::string add(ApiKey key);
  /// The key of this text, if it is one.
  std::optional<ApiKey> find(std::string_view text);
  [[nodiscard]] std::optional<ApiKey> with_id(std::string_view id);
  /// Whether anybody can have a key: one was added, or given.
  [[nodiscard]] bool has_any();
  /// In the order in which they were added.
  std::vector<ApiKey> all();
  /// 0 when the key may be used once more, else the whole seconds after which it may. cost: for how
  /// many uses this one counts, which are a minute's worth at most. Nodes of one database with a
  /// URL count together; uses that are not answered for that it is away may count.
  int wait_seconds(const ApiKey& key, double cost);
  /// False when there is none of this id. Its jobs stay.
  bool remove(std::string_view id);

 private:
  std::mutex mutex_;
  const std::shared_ptr<database::Database> database_;
  const std::string given_;  // SHA-256; empty: none
  const bool is_shared_;     // with other nodes
  RateLimit rates_;
};

}  // namespace unwrapd::server::access
