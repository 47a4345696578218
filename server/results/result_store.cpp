#include "server/results/result_store.hpp"

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

StoredResult ResultStore::open(const store::JobRecord& job, std::size_t map,
                               std::string_view format, const http::HasLeft& has_left) {
  const std::string file = work::map_file(blobs::result_file(format), map);
  return files_.open(job, {.file = file, .map = map, .has_left = has_left}, [&] {
    const work::Rendering rendering{.map = map, .picture = {}, .format = format_named(format)};
    return renderer_.render(job, rendering, has_left);
  });
}

std::optional<blobs::ResultLink> ResultStore::link(const store::JobRecord& job, std::size_t map,
                                                   std::string_view format,
                                                   std::string_view method) {
  if (from_ == ResultsFrom::node) return std::nullopt;
  const std::string file = work::map_file(blobs::result_file(format), map);
  return blobs_.link(job.id, job.seq, file, method, http::media_type(format));
}

}  // namespace unwrapd::server::results
