#pragma once
// The table of meshes: which owner stores which mesh, and since when. The bytes of a mesh are the
// document in its folder (blob_store.hpp); the name of the folder is never published.

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/database/database_address.hpp"

namespace unwrapd::server::store {

struct MeshRecord {
  std::string id;          ///< of its folder
  std::string owner;       ///< id of the API key that sent it; empty without keys
  std::string sha256;      ///< of its bytes; an owner has one of this digest
  std::int64_t bytes = 0;  ///< of the document
  std::string media_type;  ///< as it was sent last
  std::int64_t created_ms = 0;
  std::int64_t kept_since_ms = 0;  ///< when it was sent or made a job of last
  std::int64_t stored_bytes = 0;   ///< of all its files, as quotas count them
};

/// Thread-safe. Every function may throw Error{storage_failed, storage_full}.
class MeshStore {
 public:
  /// store: the database of the jobs, whose tables are there already.
  explicit MeshStore(const database::DatabaseAddress& store) : database_(store.open()) {}

  /// Replaces the owner's mesh of this digest, if there is one.
  void put(const MeshRecord& mesh);
  [[nodiscard]] std::optional<MeshRecord> find(std::string_view owner, std::string_view sha256);
  /// It was used now, and sent as this type, if any.
  void use(std::string_view id, std::int64_t now_ms, std::string_view media_type = {});
  void set_stored_bytes(std::string_view id, std::int64_t bytes);

  [[nodiscard]] bool has(std::string_view id);
  /// The meshes that were used last before this time, the longest unused first.
  std::vector<MeshRecord> unused_since(std::int64_t epoch_ms);
  void remove(std::string_view id);

 private:
  /// A change by one statement.
  template <class... Values>
  void update(std::string_view sql, const Values&... values) {
    const std::lock_guard lock(mutex_);
    database_->change([&] { database::Statement(*database_, sql).with(values...).run(); });
  }

  std::mutex mutex_;
  const std::shared_ptr<database::Database> database_;
};

}  // namespace unwrapd::server::store
