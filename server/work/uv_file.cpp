#include "server/work/uv_file.hpp"

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "core/base/error.hpp"

namespace unwrapd::server::work {
namespace {

constexpr std::size_t kSurfaceBytes = 3 * sizeof(std::uint64_t);  // of an empty one: its counts
constexpr std::string_view kMagic = "unwrapd uv 1\n";

void put_bytes(std::string& out, const void* data, std::size_t size) {
  if (size > 0) out.append(static_cast<const char*>(data), size);
}

template <class T>
void put(std::string& out, const std::vector<T>& items) {
  const std::uint64_t count = items.size();
  put_bytes(out, &count, sizeof count);
  put_bytes(out, items.data(), items.size() * sizeof(T));
}

[[noreturn]] void fail() {
  throw Error(ErrorCode::storage_failed, "A stored result is damaged: send the job again.");
}

void take_bytes(std::string_view& in, void* data, std::size_t size) {
  if (in.size() < size) fail();
  if (size > 0) std::memcpy(data, in.data(), size);
  in.remove_prefix(size);
}

template <class T>
void take(std::string_view& in, std::vector<T>& items) {
  std::uint64_t count = 0;
  take_bytes(in, &count, sizeof count);
  if (count > in.size() / sizeof(T)) fail();
  items.resize(count);
  take_bytes(in, static_cast<void*>(items.data()), count * sizeof(T));
}

}  // namespace

std::string encode_uvs(const std::vector<UnwrappedSurface>& surfaces) {
  std::string out(kMagic);
  const std::uint64_t count = surfaces.size();
  put_bytes(out, &count, sizeof count);
  for (const UnwrappedSurface& surface : surfaces) {
    put(out, surface.faces);
    put(out, surface.source);
    put(out, surface.uv);
  }
  return out;
}

std::vector<UnwrappedSurface> decode_uvs(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) fail();
  bytes.remove_prefix(kMagic.size());
  std::uint64_t count = 0;
  take_bytes(bytes, &count, sizeof count);
  if (count > bytes.size() / kSurfaceBytes) fail();
  std::vector<UnwrappedSurface> surfaces(count);
  for (UnwrappedSurface& surface : surfaces) {
    take(bytes, surface.faces);
    take(bytes, surface.source);
    take(bytes, surface.uv);
  }
  if (!bytes.empty()) fail();
  return surfaces;
}

}  // namespace unwrapd::server::work
