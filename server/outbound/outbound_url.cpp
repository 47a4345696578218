#include "server/outbound/outbound_url.hpp"

#include <arpa/inet.h>
#include <netdb.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/base/error.hpp"
#include "core/base/lower_case.hpp"
#include "core/base/parse_number.hpp"

namespace unwrapd::server::outbound {
namespace {

constexpr std::size_t kLongestUrl = 2000;
constexpr int kMaxPort = 65535;

[[noreturn]] void refuse(const UrlUse& use, const std::string& what) {
  throw Error(use.refused, "The " + std::string(use.whose) + "'s address " + what,
              std::string(use.where));
}

struct Network {
  std::uint32_t address;
  int bits;
};
// What of IPv4 is not the public internet (RFC 6890).
constexpr std::array<Network, 15> kSpecial = {{{0x00000000, 8},
                                               {0x0A000000, 8},
                                               {0x64400000, 10},
                                               {0x7F000000, 8},
                                               {0xA9FE0000, 16},
                                               {0xAC100000, 12},
                                               {0xC0000000, 24},
                                               {0xC0000200, 24},
                                               {0xC0586300, 24},
                                               {0xC0A80000, 16},
                                               {0xC6120000, 15},
                                               {0xC6336400, 24},
                                               {0xCB007100, 24},
                                               {0xE0000000, 4},
                                               {0xF0000000, 4}}};

bool is_public_v4(std::uint32_t address) {
  return std::ranges::none_of(kSpecial, [&](const Network& network) {
    return (address ^ network.address) >> (32 - network.bits) == 0;
  });
}

/// Global unicast is 2000::/3; of it, 2001::/23 (tunnels and protocols), documentation and 6to4,
/// which wraps any IPv4 address, are not.
bool is_public_v6(const std::array<std::uint8_t, 16>& a) {
  const bool global = (a[0] & 0xE0) == 0x20;
  const bool protocols = a[0] == 0x20 && a[1] == 0x01 && a[2] < 0x02;
  const bool documentation = (a[0] == 0x20 && a[1] == 0x01 && a[2] == 0x0D && a[3] == 0xB8) ||
                             (a[0] == 0x3F && a[1] == 0xFF && a[2] < 0x10);  // RFC 9637
  const bool six_to_four = a[0] == 0x20 && a[1] == 0x02;
  return global && !protocols && !documentation && !six_to_four;
}

bool is_host_letter(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '.' ||
         letter == '-' || letter == ':';
}

bool is_printable(char letter) { return letter > ' ' && letter < '\x7f'; }

/// Removes the scheme, in any letters (RFC 3986, 3.1), from a URL and says whether it is https.
bool take_scheme(std::string_view& rest, const UrlUse& use) {
  for (const auto& [scheme, is_https] : {std::pair{std::string_view("https://"), true},
                                         std::pair{std::string_view("http://"), false}}) {
    if (!std::ranges::equal(rest.substr(0, scheme.size()), scheme, {}, lower_letter)) continue;
    rest.remove_prefix(scheme.size());
    return is_https;
  }
  refuse(use, "must begin with https:// or http://; correct it.");
}

/// The number after the host, or none.
std::optional<int> port_of(std::string_view text) {
  const std::optional<int> port = parse_number<int>(text);
  if (!port || *port < 1 || *port > kMaxPort) return std::nullopt;
  return port;
}

void read_authority(std::string_view authority, OutboundUrl& url, const UrlUse& use) {
  if (authority.find('@') != std::string_view::npos)
    refuse(use, "must not name a user; leave it out.");
  const std::size_t bracket = authority.rfind(']');
  const std::size_t colon = authority.rfind(':');
  const bool has_port =
      colon != std::string_view::npos && (bracket == std::string_view::npos || colon > bracket);
  if (has_port) {
    const std::optional<int> port = port_of(authority.substr(colon + 1));
    if (!port) refuse(use, "has a port that is not one; correct it.");
    url.port = *port;
    authority = authority.substr(0, colon);
  }
  if (authority.starts_with('[') && authority.ends_with(']'))
    authority = authority.substr(1, authority.size() - 2);
  url.host = lower_case(authority);
  if (url.host.empty() || !std::ranges::all_of(url.host, is_host_letter))
    refuse(use, "has a host that is not one; correct it.");
}

struct FreeAddresses {
  void operator()(addrinfo* list) const { freeaddrinfo(list); }
};

}  // namespace

OutboundUrl read_url(const std::string& text, const UrlUse& use) {
  const bool readable = text.size() <= kLongestUrl && std::ranges::all_of(text, is_printable) &&
                        text.find('#') == std::string::npos;
  if (!readable) refuse(use, "is not a URL of at most 2000 characters; correct it.");
  std::string_view rest = text;
  OutboundUrl url;
  url.is_https = take_scheme(rest, use);
  url.port = url.is_https ? 443 : 80;
  const std::size_t end = std::min(rest.find_first_of("/?"), rest.size());
  read_authority(rest.substr(0, end), url, use);
  const std::string_view target = rest.substr(end);
  url.target = target.starts_with('/') ? std::string(target) : "/" + std::string(target);
  return url;
}

bool is_address(const std::string& host) {
  in_addr v4{};
  std::array<std::uint8_t, 16> v6{};
  return inet_aton(host.c_str(), &v4) == 1 || inet_pton(AF_INET6, host.c_str(), v6.data()) == 1;
}

bool is_public_address(const std::string& address) {
  in_addr v4{};
  if (inet_pton(AF_INET, address.c_str(), &v4) == 1) return is_public_v4(ntohl(v4.s_addr));
  std::array<std::uint8_t, 16> v6{};
  return inet_pton(AF_INET6, address.c_str(), v6.data()) == 1 && is_public_v6(v6);
}

std::vector<std::string> addresses_of(const std::string& host) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  if (getaddrinfo(host.c_str(), nullptr, &wanted, &list) != 0) return {};
  const std::unique_ptr<addrinfo, FreeAddresses> owned(list);
  std::vector<std::string> addresses;
  for (const addrinfo* each = list; each != nullptr; each = each->ai_next) {
    std::array<char, NI_MAXHOST> text{};
    getnameinfo(each->ai_addr, each->ai_addrlen, text.data(), text.size(), nullptr, 0,
                NI_NUMERICHOST);
    addresses.emplace_back(text.data());
  }
  return addresses;
}

}  // namespace unwrapd::server::outbound
