#include "server/result_store.hpp"

#include <vector>

#include "api/options.hpp"
#include "api/result.hpp"
#include "server/job_input.hpp"
#include "server/map_choice.hpp"
#include "server/run_job.hpp"
#include "server/uv_file.hpp"

namespace unwrapd::server {
namespace {

asset::Format format_named(std::string_view name) {
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
  const std::string bytes = make(job, map, format);
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

std::string ResultStore::make(const JobRecord& job, std::size_t map,
                              std::string_view format) const {
  const LoadedInput loaded(blobs_, job);
  const asset::Asset asset = asset::read(loaded.input(), read_limits(job, limits_),
                                         api::parse_options(job.options, limits_).asset);
  const std::vector<UnwrappedSurface> surfaces =
      decode_uvs(blobs_.read(job.id, map_file(kUvFile, map)));
  if (format != "json") return asset::write(asset, surfaces, format_named(format));
  const auto report = api::Json::parse(blobs_.read(job.id, map_file(kReportFile, map)));
  return api::result_json(report, asset.surfaces(), surfaces);
}

}  // namespace unwrapd::server
