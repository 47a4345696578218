#pragma once
// Where a call to an address that a client chose may go. A server that makes such calls can be made
// to call what only it can reach (server-side request forgery): so the host must be allowed by the
// operator, every address that it resolves to must be a public one, and the call goes to the
// address that was checked. Checking the name alone was rejected: it may resolve to another address
// a moment later.

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace unwrapd::server::outbound {

/// http://host[:port][/path][?query] or https://...
struct OutboundUrl {
  bool is_https = true;
  std::string host;
  int port = 443;
  std::string target = "/";  ///< path and query
};

/// What an address is for, in the words of its refusals.
struct UrlUse {
  ErrorCode refused;
  std::string_view whose;       ///< "webhook"
  std::string_view where = {};  ///< JSON pointer
};

/// Throws Error{use.refused}: the text is no such URL, or has a user or a fragment.
OutboundUrl read_url(const std::string& text, const UrlUse& use);

/// Whether a host is in numbers, in any of the notations that resolving it knows: 127.1 and
/// 0x7f000001, too.
bool is_address(const std::string& host);

/// Whether an address in numbers is one of the public internet: not of this machine, of a private
/// or shared network, link-local, multicast or reserved (RFC 6890); false for what is no address.
bool is_public_address(const std::string& address);

/// The addresses of a host in numbers; none where it cannot be resolved.
std::vector<std::string> addresses_of(const std::string& host);

}  // namespace unwrapd::server::outbound
