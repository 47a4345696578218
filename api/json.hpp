#pragma once
// The JSON of the API. Members keep their order, numbers are finite, and input is parsed strictly
// (one value, no duplicate member, bounded depth).

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace unwrapd::api {

using Json = nlohmann::ordered_json;

struct JsonLimits {
  std::size_t max_bytes = 65'536;
  int max_depth = 16;
  std::size_t max_values =
      2'000'000;                    ///< values and names of members; some 80 bytes of memory each
  std::size_t max_members = 1'000;  ///< of one object; building it takes quadratic time
};

/// Parses one JSON value. Throws Error: malformed_request (syntax, depth, size, counts),
/// invalid_option with its JSON pointer (a duplicate member, a number beyond the range of a
/// double).
Json parse_json(std::string_view text, const JsonLimits& limits = {});

/// A number that counts from 0 and fits into 32 bits; 10.0 is one, as in JSON Schema. None: the
/// value is anything else.
std::optional<std::int32_t> index_in(const Json& value);

/// Whether the value is a list of as many finite numbers as `numbers` takes, which then has them.
bool read_numbers(const Json& value, std::span<double> numbers);

/// Replaces an infinite or undefined value by the largest double of its sign, since JSON cannot
/// express it.
double finite(double value);

/// JSON as text on one line; what is not UTF-8 in it is replaced.
std::string to_text(const Json& json);

/// Escapes text ("~" and "/") as a token of a JSON pointer (RFC 6901).
std::string pointer_token(std::string_view text);

}  // namespace unwrapd::api
