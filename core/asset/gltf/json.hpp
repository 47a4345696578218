#pragma once
// The JSON of a glTF document: read by core/json, and looked at through Node, which knows the JSON
// pointer of every value so that each error can name its place.

#include <array>
#include <limits>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/json/json.hpp"

namespace unwrapd::asset {

using json::Json;

/// Throws Error{malformed_json} with the byte of the fault: bad syntax or UTF-8, a number that no
/// double holds, a name that occurs twice in one object, more than 128 levels. Throws
/// Error{too_much_memory} before anything is kept when the tree would take more than max_bytes, or
/// more than twelve times its text and 20 MiB: so dense a text is nothing but tiny values, and a
/// document is held up to three times while it is written.
Json parse_json(std::string_view text, const std::stop_token& stop,
                std::size_t max_bytes = std::numeric_limits<std::size_t>::max());

/// A JSON pointer (RFC 6901) as it grows; a value, cheap to copy, turned into text only on error.
class Place {
 public:
  [[nodiscard]] Place at(std::string_view key) const;  ///< key must outlive the Place
  [[nodiscard]] Place at(std::size_t index) const;
  [[nodiscard]] std::string pointer() const;

 private:
  struct Step {
    std::string_view key;
    std::size_t index = 0;
  };
  static constexpr std::size_t kMaxSteps = 8;
  std::array<Step, kMaxSteps> steps_;
  std::size_t size_ = 0;
};

[[noreturn]] void fail(ErrorCode code, const Place& place, const std::string& message);

/// A value of the document and its place. Every reader throws Error{malformed_gltf} when the value
/// is not what was asked for.
class Node {
 public:
  explicit Node(const Json& json, const Place& place = {}) : json_(&json), place_(place) {}

  [[nodiscard]] const Json& json() const { return *json_; }
  [[nodiscard]] const Place& place() const { return place_; }

  [[nodiscard]] std::optional<Node> find(std::string_view key) const;  ///< of an object
  [[nodiscard]] Node at(std::string_view key) const;                   ///< of an object, required
  [[nodiscard]] Node at(std::size_t index) const;                      ///< of an array
  [[nodiscard]] std::size_t array_size() const;  ///< throws when it is no array
  void expect_object() const;

  [[nodiscard]] std::size_t number() const;  ///< a whole number in [0, 2^53]
  [[nodiscard]] std::size_t number(std::string_view key, std::size_t otherwise) const;
  [[nodiscard]] std::size_t index(std::size_t size, std::string_view list) const;
  [[nodiscard]] const std::string& text() const;
  [[nodiscard]] bool flag(std::string_view key) const;  ///< false when absent

 private:
  const Json* json_;
  Place place_;
};

}  // namespace unwrapd::asset
