#include "server/http/addresses.hpp"

#include <arpa/inet.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "core/base/parse_number.hpp"

namespace unwrapd::server::http {
namespace {

using Bytes = std::array<unsigned char, 16>;

constexpr int kV4Bits = 96;  // of an IPv6 address before an IPv4 one in it
constexpr int kAllBits = 128;
constexpr std::size_t kNetworkBytes = 8;

/// The bytes of an IPv6 address, or of an IPv4 address mapped into IPv6.
std::optional<Bytes> parse(std::string_view text) {
  const std::string address(text);
  Bytes bytes{};
  if (::inet_pton(AF_INET6, address.c_str(), bytes.data()) == 1) return bytes;
  bytes[10] = bytes[11] = 0xff;
  if (::inet_pton(AF_INET, address.c_str(), bytes.data() + kV4Bits / 8) == 1) return bytes;
  return std::nullopt;
}

bool is_mapped(const Bytes& address) {
  static const Bytes mapped = *parse("0.0.0.0");
  return std::equal(mapped.begin(), mapped.begin() + kV4Bits / 8, address.begin());
}

bool same_start(const Bytes& left, const Bytes& right, int bits) {
  const auto whole = static_cast<std::size_t>(bits / 8);
  if (!std::equal(left.begin(), left.begin() + whole, right.begin())) return false;
  const int rest = bits % 8;
  return rest == 0 || ((left[whole] ^ right[whole]) >> (8 - rest)) == 0;
}

/// The bits of "/24"; `most` for an empty text; std::nullopt for anything else.
std::optional<int> prefix_bits(std::string_view text, int most) {
  if (text.empty()) return most;
  const std::optional<int> bits = parse_number<int>(text.substr(1));
  if (!bits || *bits < 0 || *bits > most) return std::nullopt;
  return bits;
}

std::string_view trimmed(std::string_view text) {
  constexpr const char* space = " \t";
  const std::size_t first = text.find_first_not_of(space);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(space) - first + 1);
}

/// The address of "10.0.0.1", "10.0.0.1:80", "::1", "[::1]" and "[::1]:80": some proxies add ports.
std::string_view without_port(std::string_view text) {
  const std::size_t bracket = text.find(']');
  if (text.starts_with('[') && bracket != std::string_view::npos)
    return text.substr(1, bracket - 1);
  const std::size_t colon = text.find(':');
  const bool has_port = colon != std::string_view::npos && text.rfind(':') == colon;
  return has_port ? text.substr(0, colon) : text;
}

}  // namespace

AddressSet::AddressSet(const std::vector<std::string>& ranges) {
  for (const std::string& text : ranges) {
    const std::size_t slash = std::min(text.find('/'), text.size());
    const std::optional<Bytes> bytes = parse(text.substr(0, slash));
    const bool is_v4 = text.find(':') == std::string::npos;
    const std::optional<int> bits =
        prefix_bits(std::string_view(text).substr(slash), is_v4 ? kAllBits - kV4Bits : kAllBits);
    if (!bytes || !bits)
      throw Error(ErrorCode::invalid_option, "addresses and ranges such as 10.0.0.0/8 or ::1");
    if (!is_v4 && is_mapped(*bytes) && *bits < kV4Bits) {
      throw Error(ErrorCode::invalid_option,
                  "IPv4 ranges as 10.0.0.0/8 or ::ffff:10.0.0.0/104: with fewer than 96 bits a "
                  "mapped one is every IPv4 address");
    }
    ranges_.push_back({*bytes, *bits + (is_v4 ? kV4Bits : 0)});
  }
}

bool AddressSet::contains(std::string_view address) const {
  const std::optional<Bytes> bytes = parse(address);
  return bytes && std::ranges::any_of(ranges_, [&](const Range& range) {
           return same_start(range.bytes, *bytes, range.bits);
         });
}

std::string client_behind(const std::string& peer, std::string_view forwarded,
                          const AddressSet& trusted) {
  std::string client = peer;
  while (!forwarded.empty() && trusted.contains(client)) {
    const std::size_t comma = forwarded.rfind(',');
    const std::size_t start = comma == std::string_view::npos ? 0 : comma + 1;
    const std::string_view next = without_port(trimmed(forwarded.substr(start)));
    if (!parse(next)) break;
    client = next;
    forwarded = forwarded.substr(0, comma == std::string_view::npos ? 0 : comma);
  }
  return client;
}

bool is_loopback(std::string_view address) {
  static const AddressSet loopback({"127.0.0.0/8", "::1"});
  return loopback.contains(address);
}

std::string network_of(const std::string& address) {
  const std::optional<Bytes> bytes = parse(address);
  if (!bytes || address.find(':') == std::string::npos) return address;
  return {bytes->begin(), bytes->begin() + kNetworkBytes};
}

std::optional<Address> parse_address(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return std::nullopt;
  const std::optional<int> port = parse_number<int>(text.substr(colon + 1));
  std::string_view host = text.substr(0, colon);
  const bool bracketed = host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  if (host.empty() || !port || *port < 0 || *port > kMaxPort) return std::nullopt;
  return Address{.host = std::string(host), .port = *port};
}

std::string to_text(const Address& address) {
  const bool is_ipv6 = address.host.find(':') != std::string::npos;
  const std::string host = is_ipv6 ? "[" + address.host + "]" : address.host;
  return host + ":" + std::to_string(address.port);
}

}  // namespace unwrapd::server::http
