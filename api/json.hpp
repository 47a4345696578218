#pragma once
// The JSON of the wire: members keep the order in which they are written, numbers are finite, and
// what comes from outside is read strictly (one value, no duplicate member, bounded depth).

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>
#include <string_view>

namespace unwrapd::api {

using Json = nlohmann::ordered_json;

struct JsonLimits {
  std::size_t max_bytes = 65'536;
  int max_depth = 16;
  std::size_t max_values = 2'000'000;  ///< and names of members: some 80 bytes of memory each
  std::size_t max_members = 1'000;     ///< of one object: making it costs their square
};

/// Parses one JSON value. Throws Error: malformed_request (syntax, depth, size, counts),
/// invalid_option with its JSON pointer (a member given twice, a number beyond the range of a
/// double).
Json parse_json(std::string_view text, const JsonLimits& limits = {});

/// value as JSON can hold it: an infinite or undefined figure becomes the largest double of its
/// sign, since JSON has no name for it.
double finite(double value);

/// text as a member of a JSON pointer (RFC 6901): "~" and "/" are escaped.
std::string pointer_token(std::string_view text);

}  // namespace unwrapd::api
