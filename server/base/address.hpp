#pragma once
// A place to listen at: HOST:PORT, with brackets around an IPv6 host.

#include <optional>
#include <string>
#include <string_view>

namespace unwrapd::server {

inline constexpr int kMaxPort = 65535;

struct Address {
  std::string host;
  int port = 0;  ///< 0: a free one

  bool operator==(const Address&) const = default;
};

/// Nothing when text is not HOST:PORT, or the port not 0 to 65535.
std::optional<Address> parse_address(std::string_view text);

/// "127.0.0.1:8080", "[::1]:8080".
std::string to_text(const Address& address);

}  // namespace unwrapd::server
