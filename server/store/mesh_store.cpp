#include "server/store/mesh_store.hpp"

namespace unwrapd::server::store {
namespace {

constexpr const char* kSelect =
    "SELECT id, owner, sha256, bytes, media_type, created_ms, kept_since_ms, stored_bytes"
    " FROM meshes ";

std::string select_meshes(std::string_view rest) { return kSelect + std::string(rest); }

std::vector<MeshRecord> mesh_rows(database::Statement& statement) {
  std::vector<MeshRecord> meshes;
  while (statement.step()) {
    meshes.push_back({.id = statement.text(0),
                      .owner = statement.text(1),
                      .sha256 = statement.text(2),
                      .bytes = statement.number(3),
                      .media_type = statement.text(4),
                      .created_ms = statement.number(5),
                      .kept_since_ms = statement.number(6),
                      .stored_bytes = statement.number(7)});
  }
  return meshes;
}

}  // namespace

void MeshStore::put(const MeshRecord& mesh) {
  update(
      "INSERT INTO meshes (id, owner, sha256, bytes, media_type, created_ms, kept_since_ms,"
      " stored_bytes) VALUES (?, ?, ?, ?, ?, ?, ?, ?)"
      " ON CONFLICT (owner, sha256) DO UPDATE SET id = excluded.id, bytes = excluded.bytes,"
      " media_type = excluded.media_type, created_ms = excluded.created_ms,"
      " kept_since_ms = excluded.kept_since_ms, stored_bytes = excluded.stored_bytes",
      mesh.id, mesh.owner, mesh.sha256, mesh.bytes, mesh.media_type, mesh.created_ms,
      mesh.kept_since_ms, mesh.stored_bytes);
}

std::optional<MeshRecord> MeshStore::find(std::string_view owner, std::string_view sha256) {
  const std::lock_guard lock(mutex_);
  database::Statement statement(*database_, select_meshes("WHERE owner = ? AND sha256 = ?"));
  std::vector<MeshRecord> found = mesh_rows(statement.with(owner, sha256));
  if (found.empty()) return std::nullopt;
  return std::move(found.front());
}

void MeshStore::use(std::string_view id, std::int64_t now_ms, std::string_view media_type) {
  update(
      "UPDATE meshes SET kept_since_ms = ?2,"
      " media_type = CASE ?3 WHEN '' THEN media_type ELSE ?3 END WHERE id = ?1",
      id, now_ms, media_type);
}

void MeshStore::set_stored_bytes(std::string_view id, std::int64_t bytes) {
  update("UPDATE meshes SET stored_bytes = ?2 WHERE id = ?1", id, bytes);
}

bool MeshStore::has(std::string_view id) {
  const std::lock_guard lock(mutex_);
  database::Statement statement(*database_, select_meshes("WHERE id = ?"));
  return statement.with(id).step();
}

std::vector<MeshRecord> MeshStore::unused_since(std::int64_t epoch_ms) {
  const std::lock_guard lock(mutex_);
  database::Statement statement(
      *database_, select_meshes("WHERE kept_since_ms < ? ORDER BY kept_since_ms, seq"));
  return mesh_rows(statement.with(epoch_ms));
}

void MeshStore::remove(std::string_view id) { update("DELETE FROM meshes WHERE id = ?", id); }

}  // namespace unwrapd::server::store
