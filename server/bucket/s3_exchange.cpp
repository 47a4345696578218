#include "server/bucket/s3_exchange.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <ctime>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/lower_case.hpp"
#include "server/base/identity.hpp"
#include "server/bucket/s3_signature.hpp"
#include "server/outbound/transfer.hpp"

namespace unwrapd::server::bucket {
namespace {

constexpr long kConnectSeconds = 3;
constexpr long kStalledSeconds = 15;
constexpr std::size_t kMostInMemory = std::size_t{16} * 1024 * 1024;

struct FreeLines {
  void operator()(curl_slist* list) const { outbound::CurlLibrary::loaded().slist_free_all(list); }
};
using HeaderLines = std::unique_ptr<curl_slist, FreeLines>;

void append(HeaderLines& lines, const std::string& line) {
  curl_slist* const longer =
      outbound::CurlLibrary::loaded().slist_append(lines.get(), line.c_str());
  if (longer == nullptr) throw std::bad_alloc();
  static_cast<void>(lines.release());
  lines.reset(longer);
}

UnsignedRequest unsigned_request(const Call& call, const BucketAddress& address) {
  UnsignedRequest request{.method = call.method,
                          .host = address.host,
                          .path = "/" + address.bucket,
                          .query = call.query,
                          .headers = call.headers,
                          .body_sha256 = call.body == nullptr ? sha256("") : call.body->sha256};
  if (!call.key.empty()) request.path += "/" + address.prefix + call.key;
  return request;
}

HeaderLines lines_of(const UnsignedRequest& request, const BucketAddress& address) {
  HeaderLines lines;
  for (const std::string& line : signed_headers(request, address.credentials, address.region,
                                                signing_time(std::time(nullptr))))
    append(lines, line);
  append(lines, "Expect:");
  return lines;
}

std::string_view trimmed(std::string_view text) {
  const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

template <class Value>
void set(CURL* easy, CURLoption option, Value value) {
  if (outbound::CurlLibrary::loaded().easy_setopt(easy, option, value) != CURLE_OK)
    throw Error(ErrorCode::internal, "libcurl does not know an option of calls to a bucket.");
}

}  // namespace

Body body_of(std::string_view bytes) {
  return {.bytes = static_cast<std::int64_t>(bytes.size()),
          .sha256 = sha256(bytes),
          .read = [bytes](std::int64_t offset, std::size_t most) {
            return std::string(bytes.substr(static_cast<std::size_t>(offset), most));
          }};
}

std::string S3Exchange::run(CURL* easy, const BucketAddress& address) {
  const UnsignedRequest request = unsigned_request(call_, address);
  const HeaderLines lines = lines_of(request, address);
  const std::string query = encoded_query(request.query);
  const std::string url = address.scheme + "://" + address.host + encoded_path(request.path) +
                          (query.empty() ? "" : "?") + query;
  set(easy, CURLOPT_URL, url.c_str());
  set(easy, CURLOPT_HTTPHEADER, lines.get());
  set_options(easy, address);
  const outbound::NoSigpipe quiet;
  const outbound::CurlLibrary& curl = outbound::CurlLibrary::loaded();
  const CURLcode result = curl.easy_perform(easy);
  if (thrown_) std::rethrow_exception(thrown_);
  return result == CURLE_OK ? "" : curl.easy_strerror(result);
}

void S3Exchange::set_options(CURL* easy, const BucketAddress& address) {
  set(easy, CURLOPT_PROTOCOLS_STR, address.scheme.c_str());
  set(easy, CURLOPT_SSLVERSION, long{CURL_SSLVERSION_TLSv1_2});
  set(easy, CURLOPT_USERAGENT, "unwrapd/" UNWRAPD_VERSION);
  set(easy, CURLOPT_NOSIGNAL, 1L);
  set(easy, CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
  set(easy, CURLOPT_LOW_SPEED_LIMIT, 1L);
  set(easy, CURLOPT_LOW_SPEED_TIME, kStalledSeconds);
  set(easy, CURLOPT_HEADERFUNCTION, &line_came);
  set(easy, CURLOPT_HEADERDATA, this);
  set(easy, CURLOPT_WRITEFUNCTION, &body_came);
  set(easy, CURLOPT_WRITEDATA, this);
  if (call_.body != nullptr) {
    set(easy, CURLOPT_UPLOAD, 1L);
    set(easy, CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(call_.body->bytes));
    set(easy, CURLOPT_READFUNCTION, &read_body);
    set(easy, CURLOPT_READDATA, this);
    set(easy, CURLOPT_SEEKFUNCTION, &seek_body);
    set(easy, CURLOPT_SEEKDATA, this);
  }
  if (call_.method == "HEAD")
    set(easy, CURLOPT_NOBODY, 1L);
  else
    set(easy, CURLOPT_CUSTOMREQUEST, call_.method.c_str());
}

template <class Step>
bool S3Exchange::goes_on(const Step& step) {
  try {
    return step();
  } catch (...) {
    thrown_ = std::current_exception();
    return false;
  }
}

std::size_t S3Exchange::read_body(char* buffer, std::size_t one, std::size_t count, void* self) {
  auto& exchange = *static_cast<S3Exchange*>(self);
  std::string piece;
  const bool is_read = exchange.goes_on([&] {
    piece = exchange.call_.body->read(exchange.sent_, one * count);
    return true;
  });
  if (!is_read) return CURL_READFUNC_ABORT;
  std::memcpy(buffer, piece.data(), piece.size());
  exchange.sent_ += static_cast<std::int64_t>(piece.size());
  return piece.size();
}

/// Where the connection broke before the answer, libcurl sends the body again over another.
int S3Exchange::seek_body(void* self, curl_off_t offset, int origin) {
  if (origin != SEEK_SET) return CURL_SEEKFUNC_CANTSEEK;
  static_cast<S3Exchange*>(self)->sent_ = offset;
  return CURL_SEEKFUNC_OK;
}

void S3Exchange::take_line(std::string_view line) {
  if (line.starts_with("HTTP/")) {
    answer_.headers.clear();
    const std::string_view status = line.substr(std::min(line.find(' ') + 1, line.size()));
    std::from_chars(status.data(), status.data() + status.size(), answer_.status);
    return;
  }
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return;
  answer_.headers[lower_case(line.substr(0, colon))] = trimmed(line.substr(colon + 1));
}

bool S3Exchange::take_body(std::string_view bytes) {
  if (call_.take && answer_.is_success()) {
    call_.take(bytes);
    return true;
  }
  if (answer_.body.size() + bytes.size() > kMostInMemory) return false;
  answer_.body += bytes;
  return true;
}

std::size_t S3Exchange::line_came(const char* bytes, std::size_t, std::size_t count, void* self) {
  auto& exchange = *static_cast<S3Exchange*>(self);
  const bool is_taken = exchange.goes_on([&] {
    exchange.take_line({bytes, count});
    return true;
  });
  return is_taken ? count : 0;
}

std::size_t S3Exchange::body_came(const char* bytes, std::size_t, std::size_t count, void* self) {
  auto& exchange = *static_cast<S3Exchange*>(self);
  return exchange.goes_on([&] { return exchange.take_body({bytes, count}); }) ? count : 0;
}

}  // namespace unwrapd::server::bucket
