#include "server/results/result_store.hpp"

#include "core/base/error.hpp"
#include "server/base/identity.hpp"
#include "server/http/media_types.hpp"
#include "server/work/lambda_selection.hpp"

namespace unwrapd::server::results {
namespace {

/// Nothing for JSON.
std::optional<asset::Format> format_named(std::string_view name) {
  if (name == "json") return std::nullopt;
  if (name == "glb") return asset::Format::glb;
  return name == "gltf" ? asset::Format::gltf : asset::Format::obj;
}

}  // namespace

std::optional<StoredResult> find_whole(const blobs::BlobStore& blobs, const std::string& job,
                                       const std::string& file) {
  if (!std::filesystem::exists(blobs.path(job, file))) return std::nullopt;
  try {
    return StoredResult{.file = blobs.open(job, file), .sha256 = blobs.digest(job, file)};
  } catch (const Error& error) {
    if (error.code() == ErrorCode::storage_corrupt) return std::nullopt;  // it is made again
    throw;
  }
}

StoredResult keep(blobs::BlobStore& blobs, const store::JobRecord& job, const std::string& file,
                  std::string_view bytes) {
  if (!blobs.try_keep(job.id, file, bytes, job.seq)) return lend(blobs, bytes);
  return {.file = blobs.open(job.id, file), .sha256 = blobs.digest(job.id, file)};
}

StoredResult lend(const blobs::BlobStore& blobs, std::string_view bytes) {
  return {.file = blobs.lend(bytes), .sha256 = sha256(bytes)};
}

StoredResult ResultStore::open(const store::JobRecord& job, std::size_t map,
                               std::string_view format, const http::HasLeft& has_left) {
  const std::string file = work::map_file(blobs::result_file(format), map);
  std::optional<StoredResult> kept = find_whole(blobs_, job.id, file);
  std::shared_ptr<void> place;
  if (!kept) {
    place = renderer_.enter(job, {.file = file, .map = map, .has_left = has_left});
    kept = find_whole(blobs_, job.id, file);  // made meanwhile
  }
  if (kept) {
    ++counts_.hits;
    return std::move(*kept);
  }
  const work::Rendering rendering{.map = map, .picture = {}, .format = format_named(format)};
  const std::string bytes = renderer_.render(job, rendering, has_left);
  counts_.made(bytes);
  return keep(blobs_, job, file, bytes);
}

std::optional<blobs::ResultLink> ResultStore::link(const store::JobRecord& job, std::size_t map,
                                                   std::string_view format,
                                                   std::string_view method) {
  if (from_ == ResultsFrom::node) return std::nullopt;
  const std::string file = work::map_file(blobs::result_file(format), map);
  return blobs_.link(job.id, job.seq, file, method, http::media_type(format));
}

}  // namespace unwrapd::server::results
