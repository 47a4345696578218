// A patched document becomes a file. All buffers become one: of each, the runs of bytes that some
// view still uses are kept, in order and at the same alignment. A buffer that carries more than
// bytes (extras, extensions) stays a buffer of its own, and then nothing is moved.
#include <algorithm>
#include <cassert>
#include <vector>

#include "core/asset/base64.hpp"
#include "core/asset/bytes.hpp"
#include "core/asset/compress.hpp"
#include "core/asset/container.hpp"
#include "core/asset/patch.hpp"
#include "core/asset/references.hpp"
#include "core/cancel.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::size_t kAlignment = 8;  // of runs of bytes, as they had in their buffers
constexpr std::string_view kDataUri = "data:application/octet-stream;base64,";

std::size_t number(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? 0 : found->get<std::size_t>();
}

std::size_t view_count(const Json& document) {
  const auto views = document.find("bufferViews");
  return views == document.end() ? 0 : views->size();
}

std::vector<char> used_views(Json& document, std::size_t count) {
  std::vector<char> used(count, 0);
  for_each_view_reference(document, [&](Json& index) {
    const auto view = index.get<std::size_t>();
    if (view < count) used[view] = 1;
  });
  return used;
}

/// Takes out the accessors that only what was replaced had used, and renumbers the others.
void drop_dead_accessors(const Gltf& gltf, Json& document) {
  const auto list = document.find("accessors");
  if (list == document.end()) return;
  const std::vector<std::size_t> before = count_accessor_references(gltf.json, list->size());
  const std::vector<std::size_t> now = count_accessor_references(document, list->size());
  std::vector<std::size_t> renumbered(list->size());
  Json kept = Json::array();
  for (std::size_t i = 0; i < renumbered.size(); ++i) {
    renumbered[i] = kept.size();
    if (now[i] > 0 || before[i] == 0) kept.push_back(std::move((*list)[i]));
  }
  *list = std::move(kept);
  for_each_accessor_reference(document, [&](Json& index) {
    const auto accessor = index.get<std::size_t>();
    if (accessor < renumbered.size()) index = renumbered[accessor];
  });
}

/// Takes out the views that only what was replaced had used, and renumbers the others.
void drop_dead_views(const Gltf& gltf, Json& document) {
  const std::size_t count = view_count(document);
  Json before = gltf.json;
  std::vector<char> used_before = used_views(before, count);
  for (const std::size_t view : gltf.spent_views) used_before[view] = 1;
  const std::vector<char> used_now = used_views(document, count);
  std::vector<std::size_t> renumbered(count);
  Json kept = Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    renumbered[i] = kept.size();
    if (used_now[i] != 0 || used_before[i] == 0) kept.push_back(document["bufferViews"][i]);
  }
  if (kept.size() == count) return;
  document["bufferViews"] = std::move(kept);
  for_each_view_reference(document, [&](Json& index) {
    const auto view = index.get<std::size_t>();
    if (view < count) index = renumbered[view];
  });
}

/// A run of bytes of a buffer that goes into the file, and where.
struct Run {
  std::size_t buffer = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t target = 0;
};

std::vector<Run> whole_buffers(const std::vector<std::string_view>& buffers) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < buffers.size(); ++i) runs.push_back({i, 0, buffers[i].size(), 0});
  return runs;
}

std::vector<Run> used_runs(const Json& document) {
  std::vector<Run> runs;
  for (const Json& view : document.at("bufferViews")) {
    const std::size_t begin = number(view, "byteOffset");
    runs.push_back({number(view, "buffer"), begin, begin + number(view, "byteLength"), 0});
  }
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
    return std::pair(a.buffer, a.begin) < std::pair(b.buffer, b.begin);
  });
  std::vector<Run> merged;
  for (const Run& run : runs) {
    if (!merged.empty() && merged.back().buffer == run.buffer && run.begin <= merged.back().end)
      merged.back().end = std::max(merged.back().end, run.end);
    else
      merged.push_back(run);
  }
  return merged;
}

std::string joined(const std::vector<std::string_view>& buffers, std::vector<Run>& runs) {
  std::string bytes;
  for (Run& run : runs) {
    pad(bytes, kAlignment);
    bytes.append(run.begin % kAlignment, '\0');
    run.target = bytes.size();
    bytes += buffers[run.buffer].substr(run.begin, run.end - run.begin);
  }
  return bytes;
}

const Run& run_of(const std::vector<Run>& runs, std::size_t buffer, std::size_t offset) {
  const auto after = std::upper_bound(
      runs.begin(), runs.end(), std::pair(buffer, offset),
      [](const auto& at, const Run& run) { return at < std::pair(run.buffer, run.begin); });
  assert(after != runs.begin());
  return *std::prev(after);
}

void move_views(Json& document, const std::vector<Run>& runs) {
  for (Json& view : document["bufferViews"]) {
    const std::size_t offset = number(view, "byteOffset");
    const Run& run = run_of(runs, number(view, "buffer"), offset);
    const std::size_t moved = run.target + (offset - run.begin);
    view["buffer"] = 0;
    if (moved != offset) view["byteOffset"] = moved;
  }
}

/// A buffer after the first may disappear into it when there is nothing to it but bytes.
bool can_join(const Json& buffers) {
  const auto is_plain = [](const Json& buffer) {
    return !buffer.contains("extensions") && !buffer.contains("extras");
  };
  return buffers.size() <= 1 || std::all_of(buffers.begin() + 1, buffers.end(), is_plain);
}

std::string data_uri(std::string_view bytes) {
  std::string uri(kDataUri);
  append_base64(uri, bytes);
  return uri;
}

std::string finish(Json& document, const std::vector<std::string_view>& buffers,
                   std::string_view other_chunks, Format format) {
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    Json& buffer = document["buffers"][i];
    buffer["byteLength"] = buffers[i].size();
    if (i > 0 || format == Format::gltf)
      buffer["uri"] = data_uri(buffers[i]);
    else
      buffer.erase("uri");
  }
  if (format == Format::gltf) return document.dump();
  const std::string json = document.dump();
  return join_glb(json, buffers.empty() ? std::string_view() : buffers[0], other_chunks);
}

}  // namespace

std::string assemble(const Gltf& gltf, PatchedDocument patched, Format format, bool with_meshopt) {
  Json& document = patched.json;
  std::vector<std::string_view> buffers(gltf.buffers.begin(), gltf.buffers.end());
  if (!can_join(document["buffers"])) {
    if (with_meshopt)
      throw Error(ErrorCode::invalid_option,
                  "the asset's buffers carry extras or extensions, so they cannot be compressed; "
                  "ask for compression none",
                  "/compression");
    document["buffers"].push_back(Json::object());
    buffers.push_back(patched.added);
    return finish(document, buffers, gltf.other_chunks, format);
  }
  throw_if_cancelled(gltf.stop);
  const std::size_t views_before = view_count(document);
  if (!gltf.has_foreign_references) {
    drop_dead_accessors(gltf, document);
    drop_dead_views(gltf, document);
  }
  const bool has_dead_bytes = gltf.has_dead_bytes || view_count(document) < views_before;
  buffers.push_back(patched.added);
  std::vector<Run> runs = has_dead_bytes ? used_runs(document) : whole_buffers(buffers);
  std::string bytes = joined(buffers, runs);
  throw_if_cancelled(gltf.stop);
  move_views(document, runs);
  Json& list = document["buffers"];
  while (list.size() > 1) list.erase(list.size() - 1);
  if (list.empty()) list.push_back(Json::object());
  if (with_meshopt) compress_views(document, bytes);
  return finish(document, {bytes}, gltf.other_chunks, format);
}

}  // namespace unwrapd::asset
