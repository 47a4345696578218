#pragma once
// The one reader of JSON that comes from outside: strict, bounded, and without recursion. Members
// keep the order of their author. Integers keep all 64 bits and floats their value; only an integer
// beyond 64 bits turns into the nearest double.

#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace unwrapd::json {

using Json = nlohmann::ordered_json;

/// Why a text is refused.
enum class Fault {
  too_long,          ///< figure: the most bytes
  too_dense,         ///< figure: the bytes that its tree would take
  syntax,            ///< of JSON or of UTF-8; figure: the byte
  number_range,      ///< no double holds a number; figure: the byte
  repeated_name,     ///< of an object
  too_deep,          ///< figure: the most levels
  too_many_values,   ///< figure: the most values and names
  too_many_members,  ///< of an object; figure: the most
};

struct Refusal {
  Fault fault;
  std::size_t figure = 0;
  std::string name = {};     ///< the member at which reading ended
  std::string pointer = {};  ///< JSON pointer (RFC 6901) of the place where reading ended
};

/// What one kind of document may hold, and how its refusals are told.
struct Policy {
  static constexpr std::size_t kUnbounded = std::numeric_limits<std::size_t>::max();

  Error (*error)(const Refusal&);
  std::size_t max_bytes = kUnbounded;
  std::size_t max_tree_bytes = kUnbounded;  ///< of memory, foreseen before anything is kept
  std::size_t max_depth = 128;
  std::size_t max_values = kUnbounded;   ///< and names of members
  std::size_t max_members = kUnbounded;  ///< of one object
};

/// Reads one JSON value. Throws policy.error() of the first fault in the text.
Json read(std::string_view text, const Policy& policy, const std::stop_token& stop = {});

/// An upper bound of the memory that the text's tree will take, by counting its marks.
std::size_t tree_bytes(std::string_view text, const std::stop_token& stop);

/// text as a member of a JSON pointer (RFC 6901): "~" and "/" are escaped.
std::string pointer_token(std::string_view text);

}  // namespace unwrapd::json
