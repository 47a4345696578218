#include "server/result_store.hpp"

#include "core/error.hpp"
#include "server/map_choice.hpp"

namespace unwrapd::server {
namespace {

/// Nothing for JSON.
std::optional<asset::Format> format_named(std::string_view name) {
  if (name == "json") return std::nullopt;
  if (name == "glb") return asset::Format::glb;
  return name == "gltf" ? asset::Format::gltf : asset::Format::obj;
}

}  // namespace

std::string_view format_name(asset::Format format) {
  switch (format) {
    case asset::Format::glb:
      return "glb";
    case asset::Format::gltf:
      return "gltf";
    case asset::Format::obj:
      return "obj";
  }
  return "glb";
}

void write_result(BlobStore& blobs, std::string_view job, std::string_view format,
                  std::string_view bytes) {
  blobs.write(job, result_file(format), bytes);
}

StoredResult ResultStore::open(const JobRecord& job, std::size_t map, std::string_view format) {
  const std::string file = map_file(result_file(format), map);
  std::optional<StoredResult> kept = find(job, file);
  std::unique_lock lock(making_, std::defer_lock);
  if (!kept) {
    lock.lock();
    kept = find(job, file);  // made meanwhile
  }
  if (kept) {
    ++counts_.hits;
    return std::move(*kept);
  }
  const Rendering rendering{.map = map, .picture = {}, .format = format_named(format)};
  const std::string bytes = renderer_.render(job, rendering);
  counts_.made(bytes);
  blobs_.write(job.id, file, bytes);
  const std::string digest = blobs_.note(job.id, file);
  return {.file = blobs_.open(job.id, file), .sha256 = digest};
}

std::optional<StoredResult> ResultStore::find(const JobRecord& job, const std::string& file) const {
  if (!std::filesystem::exists(blobs_.path(job.id, file))) return std::nullopt;
  try {
    return StoredResult{.file = blobs_.open(job.id, file), .sha256 = blobs_.digest(job.id, file)};
  } catch (const Error& error) {
    if (error.code() == ErrorCode::storage_corrupt) return std::nullopt;  // it is made again
    throw;
  }
}

}  // namespace unwrapd::server
