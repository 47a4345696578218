#include "core/asset/gltf/container.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/asset/base/bytes.hpp"
#include "core/base/error.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::uint32_t kMagic = 0x46546c67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004e4942;   // "BIN\0"
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

struct Chunk {
  std::uint32_t type = 0;
  std::string_view bytes;
  std::size_t end = 0;  ///< where its bytes end
};

[[noreturn]] void refuse(const std::string& message, std::size_t byte) {
  throw Error(ErrorCode::malformed_glb, message + "; send the whole file or export it again",
              "byte " + std::to_string(byte));
}

std::uint32_t word(std::string_view file, std::size_t offset) {
  if (file.size() < 4 || offset > file.size() - 4) refuse("the GLB ends too early", file.size());
  return load<std::uint32_t>(file.data() + offset);
}

Chunk chunk_at(std::string_view file, std::size_t offset) {
  const std::size_t length = word(file, offset);
  const std::uint32_t type = word(file, offset + 4);
  const std::size_t begin = offset + kChunkHeaderBytes;
  if (length > file.size() - begin) refuse("a chunk of the GLB is longer than the file", offset);
  return {type, file.substr(begin, length), begin + length};
}

/// The file up to its stated length; padding after that is ignored.
std::string_view checked(std::string_view file) {
  if (word(file, 0) != kMagic) refuse("the GLB does not begin with \"glTF\"", 0);
  if (word(file, 4) != 2) refuse("only version 2 of the GLB container can be read", 4);
  const std::size_t length = word(file, 8);
  if (length > file.size())
    refuse("the GLB states more than the " + std::to_string(file.size()) + " bytes that were sent",
           8);
  return file.substr(0, length);
}

bool is_aligned(const Chunk& chunk) { return chunk.bytes.size() % 4 == 0; }

/// The start of the next chunk, or the end of the file.
std::size_t next_chunk(std::string_view file, const Chunk& chunk) {
  const std::size_t padded = chunk.end + (4 - chunk.bytes.size() % 4) % 4;
  const auto is_start = [&](std::size_t offset) {
    return file.size() - offset >= kChunkHeaderBytes &&
           word(file, offset) <= file.size() - offset - kChunkHeaderBytes;
  };
  if (is_aligned(chunk) || is_start(chunk.end)) return chunk.end;
  return std::min(padded, file.size());
}

void append_chunk(std::string& file, std::uint32_t type, std::string_view bytes, char padding) {
  append(file, static_cast<std::uint32_t>((bytes.size() + 3) / 4 * 4));
  append(file, type);
  file += bytes;
  pad(file, 4, padding);
}

}  // namespace

GlbChunks split_glb(std::string_view bytes) {
  const std::string_view file = checked(bytes);
  const Chunk json = chunk_at(file, kHeaderBytes);
  if (json.type != kJsonChunk) refuse("the first chunk of the GLB is not JSON", kHeaderBytes);
  GlbChunks chunks{.json = json.bytes, .unaligned = is_aligned(json) ? 0 : 1};
  bool is_second = true;
  for (std::size_t offset = next_chunk(file, json); offset < file.size(); is_second = false) {
    const Chunk chunk = chunk_at(file, offset);
    if (is_second && chunk.type == kBinChunk)
      chunks.bin = chunk.bytes;
    else
      append_chunk(chunks.others, chunk.type, chunk.bytes, '\0');
    chunks.unaligned += is_aligned(chunk) ? 0 : 1;
    offset = next_chunk(file, chunk);
  }
  return chunks;
}

std::string join_glb(std::string_view json, std::string_view bin, std::string_view others) {
  const std::size_t length = kHeaderBytes + 2 * kChunkHeaderBytes + (json.size() + 3) / 4 * 4 +
                             (bin.size() + 3) / 4 * 4 + others.size();
  if (length > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::body_too_large,
                "the result does not fit into a GLB of 4 GiB; split the asset or ask for glTF");
  std::string file;
  file.reserve(length);
  append(file, kMagic);
  append(file, std::uint32_t{2});
  append(file, static_cast<std::uint32_t>(length));
  append_chunk(file, kJsonChunk, json, ' ');
  append_chunk(file, kBinChunk, bin, '\0');
  file += others;
  return file;
}

}  // namespace unwrapd::asset
