#pragma once
// Values to bytes and back, for two processes of one program. Reading checks every length.

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

namespace unwrapd {

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
  /// Item: a value, or an array or a vector of a fixed size of values, without padding.
  template <class Item>
  BytePacker& add_list(const std::vector<Item>& list) {
    add(static_cast<std::uint64_t>(list.size()));
    bytes_.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(Item));
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
  /// Takes memory for no more than there is.
  template <class Item>
  std::vector<Item> next_list() {
    const auto count = next<std::uint64_t>();
    if (count > left_.size() / sizeof(Item)) end_early();
    std::vector<Item> list(count);
    const std::string_view bytes = cut(count * sizeof(Item));
    if (count > 0) std::memcpy(static_cast<void*>(list.data()), bytes.data(), bytes.size());
    return list;
  }
  [[nodiscard]] bool empty() const { return left_.empty(); }
  [[nodiscard]] std::size_t size() const { return left_.size(); }

 private:
  [[noreturn]] static void end_early() {
    throw Error(ErrorCode::internal, "A message ends too early.");
  }
  std::string_view cut(std::uint64_t size) {
    if (size > left_.size()) end_early();
    const std::string_view bytes = left_.substr(0, size);
    left_.remove_prefix(size);
    return bytes;
  }

  std::string_view left_;
};

}  // namespace unwrapd
