#pragma once
// Addresses: where a server listens, and which client asks. A client's address is found behind
// trusted proxies. X-Forwarded-For counts as far as the chain of trusted proxies reaches and no
// farther, as anybody can send the header.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server::http {

inline constexpr int kMaxPort = 65535;

/// A host and a port.
struct Address {
  std::string host;
  int port = 0;  ///< 0: a free one

  bool operator==(const Address&) const = default;
};

/// std::nullopt unless the text is HOST:PORT with a port from 0 to 65535.
std::optional<Address> parse_address(std::string_view text);

/// "127.0.0.1:8080", "[::1]:8080".
std::string to_text(const Address& address);

/// Addresses as ranges: "10.0.0.0/8", "::1", "192.168.1.7". Thread-safe.
class AddressSet {
 public:
  AddressSet() = default;
  /// Throws Error{invalid_option} for what is no such range.
  explicit AddressSet(const std::vector<std::string>& ranges);

  [[nodiscard]] bool contains(std::string_view address) const;

 private:
  struct Range {
    std::array<unsigned char, 16> bytes{};
    int bits = 0;
  };
  std::vector<Range> ranges_;
};

/// The last address of peer's chain that is not a trusted proxy. forwarded: the
/// values of X-Forwarded-For in their order, joined with commas.
std::string client_behind(const std::string& peer, std::string_view forwarded,
                          const AddressSet& trusted);

/// True for 127.0.0.0/8 and ::1.
bool is_loopback(std::string_view address);

/// The network that an address is counted by: of an IPv6 address its /64, the least that one
/// customer of a provider has; else the address.
std::string network_of(const std::string& address);

}  // namespace unwrapd::server::http
