// EXT_meshopt_compression, and KHR_meshopt_compression as far as its streams are of the first
// version. Decoded sizes are bounded by what the codecs can reach: a vertex stream spends at least
// 2 bits on 16 bytes, an index stream a byte on a triangle or an index. Only then is memory taken.
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <tuple>

#include "core/asset/base/bytes.hpp"
#include "core/asset/codec/decompress.hpp"
#include "core/asset/codec/meshopt_filters.hpp"
#include "core/asset/gltf/extensions.hpp"
#include "core/asset/gltf/new_accessors.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::codec {
namespace {

constexpr std::size_t kMaxVertexRatio = 64;
constexpr std::size_t kMaxDecodedBytes = std::size_t{2} << 30;
constexpr std::size_t kFreeDecodedBytes = std::size_t{16} << 20;  // that any file may have
constexpr std::size_t kMaxDocumentRatio = 32;                     // of all streams together
constexpr std::array<std::string_view, 2> kNames = {"EXT_meshopt_compression",
                                                    "KHR_meshopt_compression"};

/// A compressed view: `count` elements of `stride` bytes in `stream`.
struct Stream {
  std::string_view bytes;
  std::size_t count = 0;
  std::size_t stride = 0;
  std::string mode;
  std::string filter;
  Place place;
};

[[noreturn]] void refuse_stream(const Place& place, const std::string& message) {
  fail(ErrorCode::malformed_meshopt, place, message + "; compress the asset again");
}

std::string_view stream_bytes(const Gltf& gltf, const Node& node) {
  const std::string& buffer = gltf.buffers[node.at("buffer").index(gltf.buffers.size(), "buffers")];
  const std::size_t offset = node.number("byteOffset", 0);
  const std::size_t length = node.at("byteLength").number();
  if (offset > buffer.size() || length > buffer.size() - offset)
    refuse_stream(node.place(), "the compressed data reaches beyond the end of its buffer");
  return std::string_view(buffer).substr(offset, length);
}

Stream read_stream(const Gltf& gltf, const Node& node) {
  Stream stream;
  stream.bytes = stream_bytes(gltf, node);
  stream.count = node.at("count").number();
  stream.stride = node.at("byteStride").number();
  stream.mode = node.at("mode").text();
  const std::optional<Node> filter = node.find("filter");
  stream.filter = filter ? filter->text() : "NONE";
  stream.place = node.place();
  return stream;
}

bool stride_fits(const Stream& stream) {
  const std::size_t stride = stream.stride;
  if (stream.mode != "ATTRIBUTES") return stride == 2 || stride == 4;
  if (stream.filter == "OCTAHEDRAL") return stride == 4 || stride == 8;
  if (stream.filter == "QUATERNION") return stride == 8;
  return stride > 0 && stride <= 256 && stride % 4 == 0;
}

bool count_is_possible(const Stream& stream) {
  const std::size_t bytes = stream.bytes.size();
  if (stream.mode == "ATTRIBUTES") return stream.count <= bytes * kMaxVertexRatio / stream.stride;
  if (stream.mode == "TRIANGLES") return stream.count % 3 == 0 && stream.count / 3 <= bytes;
  return stream.count <= bytes;
}

void check_names(const Stream& stream) {
  const bool attributes = stream.mode == "ATTRIBUTES";
  if (!attributes && stream.mode != "TRIANGLES" && stream.mode != "INDICES")
    refuse_stream(stream.place, "the mode is not one of ATTRIBUTES, TRIANGLES, INDICES");
  if (stream.filter == "NONE") return;
  const bool known = stream.filter == "OCTAHEDRAL" || stream.filter == "QUATERNION" ||
                     stream.filter == "EXPONENTIAL";
  if (attributes && stream.filter == "COLOR")
    fail(ErrorCode::unsupported_extension, stream.place,
         "the filter COLOR is not supported; compress the asset with EXT_meshopt_compression");
  if (!attributes || !known) refuse_stream(stream.place, "the filter does not go with the mode");
}

/// The low half of the first byte is the version: 0 for vertices, 0 or 1 for indices.
void check_version(const Stream& stream) {
  if (stream.bytes.empty()) refuse_stream(stream.place, "the compressed data is empty");
  const int version = stream.bytes.front() & 0x0f;
  if (version > (stream.mode == "ATTRIBUTES" ? 0 : 1))
    fail(ErrorCode::unsupported_extension, stream.place,
         "the compressed data is of a newer version than can be read; compress the asset with "
         "EXT_meshopt_compression");
}

void apply_filter(const Stream& stream, std::string& bytes) {
  if (stream.filter == "OCTAHEDRAL")
    decode_octahedral(bytes, stream.stride);
  else if (stream.filter == "QUATERNION")
    decode_quaternions(bytes);
  else if (stream.filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(bytes.data(), stream.count, stream.stride);
}

std::string decoded(const Stream& stream) {
  std::string bytes(stream.count * stream.stride, '\0');
  const auto* from = reinterpret_cast<const unsigned char*>(stream.bytes.data());
  using Decode = int (*)(void*, std::size_t, std::size_t, const unsigned char*, std::size_t);
  const Decode decode = stream.mode == "ATTRIBUTES"  ? Decode{meshopt_decodeVertexBuffer}
                        : stream.mode == "TRIANGLES" ? Decode{meshopt_decodeIndexBuffer}
                                                     : Decode{meshopt_decodeIndexSequence};
  if (decode(bytes.data(), stream.count, stream.stride, from, stream.bytes.size()) != 0)
    refuse_stream(stream.place, "the compressed data is damaged");
  apply_filter(stream, bytes);
  return bytes;
}

/// The view's extension and its name; empty if the view is not compressed.
std::optional<std::pair<Node, std::string_view>> compression_of(const Node& view) {
  const std::optional<Node> extensions = view.find("extensions");
  if (!extensions) return std::nullopt;
  for (const std::string_view name : kNames)
    if (const std::optional<Node> found = extensions->find(name)) return std::pair(*found, name);
  return std::nullopt;
}

/// The stream of a view, fully checked before it is decoded.
Stream checked_stream(const Gltf& gltf, const Node& extension, std::size_t length) {
  Stream stream = read_stream(gltf, extension);
  check_names(stream);
  check_version(stream);
  if (!stride_fits(stream))
    refuse_stream(extension.place(), "the stride does not go with the mode");
  if (!count_is_possible(stream))
    refuse_stream(extension.place(), "it states more elements than its data can hold");
  if (stream.count * stream.stride != length)
    refuse_stream(extension.place(),
                  "its count and stride do not give the length of the buffer view");
  return stream;
}

/// The decoded bytes of all views, one after another. Views of the same stream share them.
class Decoded {
 public:
  explicit Decoded(const Gltf& gltf) {
    std::size_t bytes = 0;
    for (const std::string& buffer : gltf.buffers) bytes += buffer.size();
    most_ = std::min(kMaxDecodedBytes, kFreeDecodedBytes + kMaxDocumentRatio * bytes);
  }

  /// The start of the decoded stream.
  std::size_t offset_of(const Stream& stream) {
    const auto [found, is_new] = offsets_.try_emplace(
        {stream.bytes.data(), stream.bytes.size(), stream.stride, stream.mode, stream.filter});
    if (!is_new) return found->second;
    if (stream.count * stream.stride > most_ - std::min(most_, bytes_.size()))
      refuse_stream(stream.place, "the asset decodes to more than its size allows, or than 2 GiB");
    pad(bytes_, 4);
    found->second = bytes_.size();
    bytes_ += decoded(stream);
    return found->second;
  }

  std::string take() { return std::move(bytes_); }

 private:
  /// The bytes, their number, stride, mode, filter.
  using Key = std::tuple<const char*, std::size_t, std::size_t, std::string, std::string>;

  std::size_t most_ = 0;
  std::string bytes_;
  std::map<Key, std::size_t> offsets_;
};

/// Removes the buffers without bytes that no view uses any longer.
void drop_fallback_buffers(Gltf& gltf) {
  std::vector<char> used(gltf.buffers.size(), 0);
  Json& views = gltf.json["bufferViews"];
  for (const Json& view : views) used[view["buffer"].get<std::size_t>()] = 1;
  std::vector<std::size_t> renumbered(gltf.buffers.size());
  Json kept = Json::array();
  std::vector<std::string> kept_bytes;
  for (std::size_t i = 0; i < gltf.buffers.size(); ++i) {
    renumbered[i] = kept.size();
    if (used[i] == 0 && gltf.buffers[i].empty()) continue;
    for (const std::string_view name : kNames) remove_extension(gltf.json["buffers"][i], name);
    kept.push_back(std::move(gltf.json["buffers"][i]));
    kept_bytes.push_back(std::move(gltf.buffers[i]));
  }
  for (Json& view : views) view["buffer"] = renumbered[view["buffer"].get<std::size_t>()];
  gltf.json["buffers"] = std::move(kept);
  gltf.buffers = std::move(kept_bytes);
}

}  // namespace

bool decode_meshopt(Gltf& gltf) {
  Decoded decoded(gltf);
  bool is_any = false, is_khr = true;
  bool has_fallback =
      !requires_extension(gltf.json, kNames[0]) && !requires_extension(gltf.json, kNames[1]);
  for (std::size_t i = 0; i < gltf.views.size(); ++i) {
    const Node view = Node(gltf.json).at("bufferViews").at(i);
    const auto compression = compression_of(view);
    if (!compression) continue;
    throw_if_cancelled(gltf.stop);
    const Stream stream = checked_stream(gltf, compression->first, gltf.views[i].length);
    Json& json = gltf.json["bufferViews"][i];
    has_fallback &= gltf.json["buffers"][gltf.views[i].buffer].contains("uri");
    json["buffer"] = gltf.buffers.size();
    json["byteOffset"] = decoded.offset_of(stream);
    is_khr = is_khr && compression->second == kNames[1];
    remove_extension(json, compression->second);
    is_any = true;
  }
  if (!is_any) return false;
  gltf.came_as = Compression::meshopt;
  gltf.came_with_fallback = has_fallback;
  if (is_khr) gltf.meshopt_name = kNames[1];
  add_buffer(gltf, decoded.take());
  for (const std::string_view name : kNames) forget_extension(gltf.json, name);
  drop_fallback_buffers(gltf);
  return true;
}

}  // namespace unwrapd::asset::codec
