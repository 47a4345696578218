#include "server/http/http_head.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "core/base/parse_number.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::http {
namespace {

constexpr std::string_view kLineEnd = "\r\n";
constexpr std::string_view kTokenSymbols = "!#$%&'*+-.^_`|~";
constexpr std::string_view kHostSymbols = "-._~%!$&'()*+,;=:[]";  // RFC 3986, 3.2.2 and 3.2.3
constexpr std::size_t kMaxLengthDigits = 18;
// Fields that are no lists (RFC 9110, 5.3), and by which a request is judged.
constexpr auto kSingle =
    std::to_array<std::string_view>({"authorization", "content-type", "idempotency-key", "if-range",
                                     "last-event-id", "origin", "unwrapd-webhook"});
constexpr auto kNoTrailers =
    std::to_array<std::string_view>({"content-length", "host", "transfer-encoding"});

struct Counts {
  int fields = 0;
  int hosts = 0;
  int lengths = 0;
  int codings = 0;
  bool stays = false;  // HTTP/1.0 that asks for it
  std::array<std::optional<std::string_view>, kSingle.size()> single = {};
};

[[noreturn]] void malformed(const std::string& what) {
  throw Error(ErrorCode::malformed_request, what);
}

[[noreturn]] void no_request_line() {
  malformed(
      "The request line is not of the form \"GET /path HTTP/1.1\"; "
      "check the client.");
}

/// Whether the text consists of letters, digits and these symbols.
bool is_made_of(std::string_view text, std::string_view symbols) {
  return std::ranges::all_of(text, [&](char c) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    return letter || symbols.find(c) != std::string_view::npos;
  });
}

bool is_token(std::string_view text) { return !text.empty() && is_made_of(text, kTokenSymbols); }

/// Of the form "Name: value".
bool is_field(std::string_view line) {
  const std::size_t colon = line.find(':');
  return colon != std::string_view::npos && is_token(line.substr(0, colon)) &&
         std::ranges::none_of(line.substr(colon), is_control);
}

/// The trimmed elements of a comma-separated list.
std::vector<std::string_view> elements(std::string_view list) {
  std::vector<std::string_view> found;
  while (true) {
    const std::size_t comma = list.find(',');
    found.push_back(trim(list.substr(0, comma)));
    if (comma == std::string_view::npos) return found;
    list.remove_prefix(comma + 1);
  }
}

/// Whether a comma-separated list has this word.
bool lists(std::string_view list, std::string_view word) {
  return std::ranges::any_of(elements(list),
                             [&](std::string_view element) { return same_word(element, word); });
}

std::int64_t length_of(std::string_view digits) {
  const auto length = parse_number<std::int64_t>(digits);
  if (!length || digits.size() > kMaxLengthDigits || digits.front() == '-')
    malformed("Content-Length is not a number of bytes; send one decimal number.");
  return *length;
}

bool needs_length(std::string_view method) {
  constexpr std::array<std::string_view, 3> with_body = {"POST", "PUT", "PATCH"};
  return std::ranges::find(with_body, method) != with_body.end();
}

/// Length of "http://host:80" before the path of an absolute target; 0 for other targets. The host
/// must obey the rules of the Host header, which it replaces.
std::size_t authority_of(std::string_view target) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (!same_word(target.substr(0, scheme.size()), scheme)) continue;
    const std::size_t end = std::min(target.find_first_of("/?#", scheme.size()), target.size());
    const std::string_view host = target.substr(scheme.size(), end - scheme.size());
    if (host.empty() || !is_made_of(host, kHostSymbols))
      malformed("The address has no host; check the client.");
    return end;
  }
  return 0;
}

/// What stands between "?" and "#".
std::string_view query_of(std::string_view target) {
  target = target.substr(0, target.find('#'));
  const std::size_t mark = target.find('?');
  return mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
}

/// Returns the method.
std::string_view vet_request_line(std::string_view line, Framing& framing) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == last || !is_token(line.substr(0, first))) no_request_line();
  if (line.size() > kMaxLineBytes)
    throw Error(ErrorCode::headers_too_large, "The address is longer than 8 KiB; shorten it.");
  const std::string_view target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  framing.target = first + 1;
  framing.query = query_of(target);
  framing.authority = authority_of(target);
  if (framing.authority == 0 && !target.starts_with('/')) no_request_line();
  const std::string_view authority = target.substr(0, framing.authority);
  if (framing.authority > 0) framing.host = authority.substr(authority.find("://") + 3);
  if (target.find(' ') != std::string_view::npos || std::ranges::any_of(target, is_control))
    malformed(
        "The address contains a space or a control character; "
        "percent-encode it.");
  if (version != "HTTP/1.1" && version != "HTTP/1.0")
    malformed("The protocol is neither HTTP/1.1 nor HTTP/1.0; use one of them.");
  return line.substr(0, first);
}

/// The first one counts.
void refuse(Framing& framing, ErrorCode code, const std::string& what) {
  if (!framing.refusal) framing.refusal.emplace(code, what);
}

void vet_single(std::string_view name, std::string_view value, Framing& framing, Counts& counts) {
  const auto is_it = [&](std::string_view single) { return same_word(name, single); };
  const auto at = std::ranges::find_if(kSingle, is_it) - kSingle.begin();
  if (at == std::ssize(kSingle)) return;
  std::optional<std::string_view>& before = counts.single.at(static_cast<std::size_t>(at));
  if (before.value_or(value) != value)
    refuse(framing, ErrorCode::malformed_request,
           "The request has two of the header " + std::string(name) + "; send one.");
  before = value;
  if (std::ranges::any_of(value, [](char c) { return c < 0; }))
    refuse(framing, ErrorCode::malformed_request,
           "The header " + std::string(name) + " is not ASCII; send ASCII.");
}

void vet_host(std::string_view value, Framing& framing, Counts& counts) {
  ++counts.hosts;
  if (framing.authority == 0) framing.host = value;  // RFC 9112, 3.2.2
  if (!is_made_of(value, kHostSymbols))
    malformed("The Host header is not a valid host; check the client.");
}

void vet_coding(std::string_view coding, Framing& framing) {
  if (same_word(coding, "identity")) return;
  const bool is_gzip = same_word(coding, "gzip") || same_word(coding, "x-gzip");
  framing.unknown_coding = framing.unknown_coding || !is_gzip || framing.gzip;
  framing.gzip = framing.gzip || is_gzip;
}

/// One gzip, or nothing. All fields of this name are one list, whose empty elements do not count
/// (RFC 9110, 5.3 and 5.6.1).
void vet_codings(std::string_view value, Framing& framing) {
  for (const std::string_view coding : elements(value))
    if (!coding.empty() || value.empty()) vet_coding(coding, framing);
  if (framing.unknown_coding)
    refuse(framing, ErrorCode::unsupported_media_type,
           "The Content-Encoding of the body must be gzip, once; send it so or uncompressed.");
}

void vet_field(std::string_view name, std::string_view value, Framing& framing, Counts& counts) {
  framing.fields.emplace_back(name, value);
  vet_single(name, value, framing, counts);
  if (same_word(name, "host")) vet_host(value, framing, counts);
  if (same_word(name, "content-length")) {
    ++counts.lengths;
    framing.content_length = length_of(value);
  }
  if (same_word(name, "transfer-encoding")) {
    ++counts.codings;
    framing.chunked = true;
    if (!same_word(value, "chunked")) malformed("Transfer-Encoding is not \"chunked\"; use that.");
  }
  if (same_word(name, "expect")) framing.awaits_continue = same_word(value, "100-continue");
  if (same_word(name, "connection")) {
    framing.last = framing.last || lists(value, "close");
    counts.stays = counts.stays || value == "Keep-Alive";  // as httplib spells it
  }
  if (same_word(name, "content-encoding")) vet_codings(value, framing);
}

void vet_counts(const Counts& counts, std::string_view method, Framing& framing) {
  if (counts.hosts > 1) malformed("There is more than one Host header; send one.");
  if (counts.hosts == 0 && !framing.version_1_0)
    malformed("HTTP/1.1 requires a Host header; send one.");
  if (counts.lengths + counts.codings > 1)
    malformed("The length of the body is stated more than once; state it once.");
  if (framing.version_1_0 && counts.codings > 0)
    malformed(
        "HTTP/1.0 has no Transfer-Encoding; use HTTP/1.1, or send "
        "Content-Length.");
  if (needs_length(method) && counts.lengths + counts.codings == 0) {
    refuse(framing, ErrorCode::length_required,
           "The length of the body is not stated; send Content-Length, or send the body chunked.");
  }
}

void to_origin_form(std::string& head, const Framing& framing) {
  const char next = head.at(framing.target + framing.authority);
  head.replace(framing.target, framing.authority, next == '/' ? "" : "/");  // no path is the root
}

/// With the fragment, which is not the server's business.
void drop_query(std::string& head, std::size_t target) {
  const std::size_t end = head.find(' ', target);
  const std::size_t begin = std::min(head.find_first_of("?#", target), end);
  head.erase(begin, end - begin);
}

void drop_ranges(std::string& head) {
  std::size_t line = head.find(kLineEnd) + kLineEnd.size();
  for (std::size_t end = head.find(kLineEnd, line); end != line; end = head.find(kLineEnd, line)) {
    const std::string_view field = std::string_view(head).substr(line, end - line);
    const std::size_t next = end + kLineEnd.size();
    if (same_word(field.substr(0, field.find(':')), "range")) {
      head.erase(line, next - line);
    } else {
      line = next;
    }
  }
}

}  // namespace

Framing vet_head(std::string_view head) {
  std::size_t end = head.find(kLineEnd);
  Framing framing;
  const std::string_view method = vet_request_line(head.substr(0, end), framing);
  Counts counts;
  framing.version_1_0 = head.substr(0, end).ends_with("1.0");
  while (true) {
    head.remove_prefix(end + kLineEnd.size());
    end = head.find(kLineEnd);
    const std::string_view line = head.substr(0, end);
    if (line.empty()) break;
    if (++counts.fields > kMaxHeaderFields)
      throw Error(ErrorCode::headers_too_large, "There are over 100 header fields; send fewer.");
    if (line.size() > kMaxLineBytes)
      throw Error(ErrorCode::headers_too_large, "A header field is longer than 8 KiB; shorten it.");
    if (!is_field(line))
      malformed("A header field is not of the form \"Name: value\"; check the client.");
    const std::size_t colon = line.find(':');
    vet_field(line.substr(0, colon), trim(line.substr(colon + 1)), framing, counts);
  }
  vet_counts(counts, method, framing);
  framing.brings_body = needs_length(method);
  if (framing.version_1_0) {
    framing.awaits_continue = false;  // it knows no 100 (RFC 9110, 10.1.1)
    framing.last = framing.last || !counts.stays;
  }
  return framing;
}

bool is_trailer(std::string_view line) {
  const std::string_view name = line.substr(0, line.find(':'));
  return is_field(line) && std::ranges::none_of(kNoTrailers, [&](std::string_view other) {
           return same_word(name, other);
         });
}

std::ptrdiff_t simplify(std::string& head, const Framing& framing) {
  const std::ptrdiff_t before = std::ssize(head);
  drop_ranges(head);
  if (framing.authority > 0) to_origin_form(head, framing);
  drop_query(head, framing.target);
  return before - std::ssize(head);
}

}  // namespace unwrapd::server::http
