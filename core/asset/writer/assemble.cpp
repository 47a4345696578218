// Turns a patched document into a file. All buffers become one. It keeps the runs of bytes that a
// view still uses, in order and at the same alignment. A buffer that has more than bytes (extras,
// extensions) stays a buffer of its own, and then nothing is moved.
#include <algorithm>
#include <vector>

#include "core/asset/base/base64.hpp"
#include "core/asset/codec/compress.hpp"
#include "core/asset/gltf/container.hpp"
#include "core/asset/gltf/references.hpp"
#include "core/asset/gltf/runs.hpp"
#include "core/asset/writer/patch.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::writer {
namespace {

std::size_t number(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? 0 : found->get<std::size_t>();
}

std::size_t view_count(const Json& document) {
  const auto views = document.find("bufferViews");
  return views == document.end() ? 0 : views->size();
}

std::vector<char> used_views(const Json& document, std::size_t count) {
  std::vector<char> used(count, 0);
  for_each_view_reference(document, [&](const Json& index) {
    const auto view = index.get<std::size_t>();
    if (view < count) used[view] = 1;
  });
  return used;
}

/// Removes the accessors that only replaced parts had used, and renumbers the others.
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

/// Removes the views that only replaced parts had used, and renumbers the others.
void drop_dead_views(const Gltf& gltf, Json& document) {
  const std::size_t count = view_count(document);
  std::vector<char> used_before = used_views(gltf.json, count);
  for (const std::size_t view : gltf.spent_views) used_before[view] = 1;
  const std::vector<char> used_now = used_views(document, count);
  std::vector<std::size_t> renumbered(count);
  Json kept = Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    renumbered[i] = kept.size();
    if (used_now[i] != 0 || used_before[i] == 0)
      kept.push_back(std::move(document["bufferViews"][i]));
  }
  const bool all = kept.size() == count;
  if (count > 0) document["bufferViews"] = std::move(kept);
  if (all) return;
  for_each_view_reference(document, [&](Json& index) {
    const auto view = index.get<std::size_t>();
    if (view < count) index = renumbered[view];
  });
}

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
  return merged(std::move(runs));
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

/// A later buffer can be joined with the first if it has nothing but bytes.
bool can_join(const Json& buffers) {
  const auto is_plain = [](const Json& buffer) {
    return !buffer.contains("extensions") && !buffer.contains("extras");
  };
  return buffers.size() <= 1 || std::all_of(buffers.begin() + 1, buffers.end(), is_plain);
}

std::string finish(const Gltf& gltf, PatchedDocument& patched,
                   const std::vector<std::string_view>& buffers, Format format) {
  Json& document = patched.json;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    Json& buffer = document["buffers"][i];
    buffer["byteLength"] = buffers[i].size();
    if (i > 0 || format == Format::gltf)
      buffer["uri"] = data_uri(buffers[i], gltf.stop);
    else
      buffer.erase("uri");
  }
  static const Aside nothing;
  std::string text =
      (patched.aside != nullptr ? *patched.aside : nothing).text_with(document, gltf.stop);
  if (format == Format::gltf) return text;
  return join_glb(text, buffers.empty() ? std::string_view() : buffers[0], gltf.other_chunks);
}

}  // namespace

std::string assemble(const Gltf& gltf, PatchedDocument patched, Format format,
                     const std::optional<codec::MeshoptStyle>& meshopt) {
  Json& document = patched.json;
  std::vector<std::string_view> buffers(gltf.buffers.begin(), gltf.buffers.end());
  if (!can_join(document["buffers"])) {
    if (meshopt)
      throw Error(ErrorCode::invalid_option,
                  "the asset's buffers carry extras or extensions, so they cannot be compressed; "
                  "ask for compression none",
                  "/compression");
    document["buffers"].push_back(Json::object());
    buffers.push_back(patched.added);
    return finish(gltf, patched, buffers, format);
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
  std::string bytes;
  append_runs(bytes, buffers, runs);
  throw_if_cancelled(gltf.stop);
  move_views(document, runs);
  Json& list = document["buffers"];
  while (list.size() > 1) list.erase(list.size() - 1);
  if (list.empty()) list.push_back(Json::object());
  if (meshopt) codec::compress_views(document, bytes, *meshopt, gltf.stop);
  return finish(gltf, patched, {bytes}, format);
}

}  // namespace unwrapd::asset::writer
