#include "server/result_store.hpp"

#include <vector>

#include "api/result.hpp"
#include "server/identity.hpp"
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

std::string digest_file(const std::string& file) { return file + ".sha256"; }

void write_with_digest(BlobStore& blobs, std::string_view job, const std::string& file,
                       std::string_view bytes) {
  blobs.write(job, digest_file(file), sha256(bytes));
  blobs.write(job, file, bytes);
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
  write_with_digest(blobs, job, result_file(format), bytes);
}

StoredResult ResultStore::open(const JobRecord& job, std::size_t map, std::string_view format) {
  const std::string file = map_file(result_file(format), map);
  const std::filesystem::path path = blobs_.path(job.id, file);
  {
    const std::lock_guard lock(making_);
    if (!std::filesystem::exists(path))
      write_with_digest(blobs_, job.id, file, make(job, map, format));
  }
  return {.file = std::make_shared<const File>(File::open(path)),
          .sha256 = read_file(blobs_.path(job.id, digest_file(file)))};
}

std::string ResultStore::make(const JobRecord& job, std::size_t map,
                              std::string_view format) const {
  const LoadedInput loaded(blobs_, job);
  const asset::Asset asset = asset::read(loaded.input(), read_limits(job, limits_));
  const std::vector<UnwrappedSurface> surfaces =
      decode_uvs(read_file(blobs_.path(job.id, map_file(kUvFile, map))));
  if (format != "json") return asset::write(asset, surfaces, format_named(format));
  const auto report = api::Json::parse(read_file(blobs_.path(job.id, map_file(kReportFile, map))));
  return api::result_json(report, asset.surfaces(), surfaces);
}

}  // namespace unwrapd::server
