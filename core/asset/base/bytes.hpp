#pragma once
// Little-endian numbers in a file's bytes, at any alignment.

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

namespace unwrapd::asset {

static_assert(std::endian::native == std::endian::little, "glTF's byte order is the machine's");

template <class T>
T load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// An unsigned number of 1, 2 or 4 bytes.
inline std::size_t load_unsigned(const char* bytes, std::size_t size) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes, size);
  return value;
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline void pad(std::string& bytes, std::size_t alignment, char with = '\0') {
  bytes.append((alignment - bytes.size() % alignment) % alignment, with);
}

}  // namespace unwrapd::asset
