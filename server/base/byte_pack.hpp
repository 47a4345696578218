#pragma once
// Values to bytes and back, for two processes of one program. Reading checks every length.

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/base/error.hpp"

namespace unwrapd::server {

class BytePacker {
 public:
  template <class Value>
  BytePacker& add(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  BytePacker& add_text(std::string_view text) {
    add(static_cast<std::uint64_t>(text.size()));
    bytes_ += text;
    return *this;
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Throws Error{internal} where the bytes end too early.
class ByteUnpacker {
 public:
  explicit ByteUnpacker(std::string_view bytes) : left_(bytes) {}

  /// Value must be one of which every bit pattern is sound.
  template <class Value>
  Value next() {
    static_assert(std::is_trivially_copyable_v<Value> && !std::is_enum_v<Value> &&
                  !std::is_same_v<Value, bool>);
    Value value;
    std::memcpy(&value, cut(sizeof value).data(), sizeof value);
    return value;
  }
  std::string_view next_text() { return cut(next<std::uint64_t>()); }
  [[nodiscard]] bool empty() const { return left_.empty(); }

 private:
  std::string_view cut(std::uint64_t size) {
    if (size > left_.size()) throw Error(ErrorCode::internal, "A message ends too early.");
    const std::string_view bytes = left_.substr(0, size);
    left_.remove_prefix(size);
    return bytes;
  }

  std::string_view left_;
};

}  // namespace unwrapd::server
