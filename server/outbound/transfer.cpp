#include "server/outbound/transfer.hpp"

#include <openssl/ssl.h>

#include <algorithm>
#include <csignal>
#include <memory>
#include <new>
#include <utility>

namespace unwrapd::server::outbound {
namespace {

constexpr long kConnectSeconds = 5;  // with the handshake of TLS
constexpr int kPollMs = 200;
constexpr std::size_t kMostStatusLine = 512;
constexpr std::size_t kMostHead = std::size_t{16} * 1024;  // bytes of all heads of an answer
constexpr int kFirstFinalStatus = 200;

/// OpenSSL's own places of certificates, which SSL_CERT_FILE and SSL_CERT_DIR change.
CURLcode trust_the_system(CURL*, void* context, void*) {
  const bool is_set = SSL_CTX_set_default_verify_paths(static_cast<SSL_CTX*>(context)) == 1;
  return is_set ? CURLE_OK : CURLE_SSL_CACERT_BADFILE;
}

std::string in_brackets(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

std::string scheme_of(const OutboundUrl& url) { return url.is_https ? "https" : "http"; }

struct FreeUrl {
  const CurlLibrary& curl;
  void operator()(CURLU* url) const { curl.url_cleanup(url); }
};

}  // namespace

NoSigpipe::NoSigpipe() {
  sigset_t pipes;
  sigemptyset(&pipes);
  sigaddset(&pipes, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipes, &before_);
}

NoSigpipe::~NoSigpipe() {
  sigset_t pipes;
  sigemptyset(&pipes);
  sigaddset(&pipes, SIGPIPE);
  const timespec now{};
  while (sigtimedwait(&pipes, nullptr, &now) > 0) continue;  // those that came meanwhile
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

Transfer::Transfer(const OutboundUrl& url, const std::string& address,
                   std::chrono::milliseconds whole)
    : Transfer() {
  set_place(url, address);
  set_limits(whole);
  add_header("Connection: close");
  set(CURLOPT_USERAGENT, "unwrapd/" UNWRAPD_VERSION);
  set(CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_1_1});
}

Transfer::~Transfer() {
  curl_.multi_cleanup(multi_);
  curl_.easy_cleanup(easy_);
  for (curl_slist* list : {headers_, connect_to_}) curl_.slist_free_all(list);
}

void Transfer::append(curl_slist*& list, const std::string& text) {
  curl_slist* const longer = curl_.slist_append(list, text.c_str());
  if (longer == nullptr) throw std::bad_alloc();
  list = longer;
}

void Transfer::add_header(const std::string& line) { append(headers_, line); }

/// Whatever libcurl makes of the host's name, it connects to the address that was checked.
void Transfer::set_place(const OutboundUrl& url, const std::string& address) {
  const std::string port = std::to_string(url.port);
  const std::string scheme = scheme_of(url);
  set(CURLOPT_URL, (scheme + "://" + in_brackets(url.host) + ":" + port + "/").c_str());
  set(CURLOPT_REQUEST_TARGET, url.target.c_str());
  append(connect_to_, "::" + in_brackets(address) + ":" + port);
  set(CURLOPT_CONNECT_TO, connect_to_);
  set(CURLOPT_PROTOCOLS_STR, scheme.c_str());
  set(CURLOPT_PROXY, "");  // none of the environment's
  set(CURLOPT_FOLLOWLOCATION, 0L);
  set(CURLOPT_CAINFO, nullptr);
  set(CURLOPT_CAPATH, nullptr);
  set(CURLOPT_SSL_CTX_FUNCTION, &trust_the_system);
  set(CURLOPT_SSLVERSION, long{CURL_SSLVERSION_TLSv1_2});
}

void Transfer::set_limits(std::chrono::milliseconds whole) {
  set(CURLOPT_NOSIGNAL, 1L);
  set(CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
  set(CURLOPT_TIMEOUT_MS, std::max<long>(1, whole.count()));  // 0 would be no limit
  set(CURLOPT_HEADERFUNCTION, &line_came);
  set(CURLOPT_HEADERDATA, this);
  set(CURLOPT_WRITEFUNCTION, &body_came);
  set(CURLOPT_WRITEDATA, this);
}

void Transfer::set_post(const std::string& body) {
  add_header("Expect:");
  set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body.size()));
  set(CURLOPT_POSTFIELDS, body.c_str());
}

/// Trailers of a body are counted like heads.
bool Transfer::take_line(std::string_view line) {
  head_bytes_ += line.size();
  if (head_bytes_ > kMostHead || (line.starts_with("HTTP/") && line.size() > kMostStatusLine))
    return false;
  if (has_final_head_) return true;
  if (take_line_) take_line_(line);
  if (line != "\r\n" && line != "\n") return true;
  has_final_head_ = status() >= kFirstFinalStatus;
  return !has_final_head_ || (take_head_ && take_head_());
}

/// libcurl's callbacks: another count than it gave ends the call.
std::size_t Transfer::line_came(const char* bytes, std::size_t, std::size_t count, void* self) {
  return static_cast<Transfer*>(self)->take_line({bytes, count}) ? count : 0;
}

std::size_t Transfer::body_came(const char* bytes, std::size_t, std::size_t count, void* self) {
  const TakeBody& take = static_cast<Transfer*>(self)->take_body_;
  return take && take({bytes, count}) ? count : 0;
}

CURLcode Transfer::perform(const std::stop_token& stop, const std::function<bool()>& must_end) {
  int running = 1;
  while (running > 0 && !stop.stop_requested() && !(must_end && must_end())) {
    if (curl_.multi_perform(multi_, &running) != CURLM_OK) return CURLE_FAILED_INIT;
    if (running > 0) curl_.multi_poll(multi_, nullptr, 0, kPollMs, nullptr);
  }
  int left = 0;
  const CURLMsg* const ended = curl_.multi_info_read(multi_, &left);
  return ended == nullptr ? CURLE_ABORTED_BY_CALLBACK : ended->data.result;
}

CURLcode Transfer::run(const std::stop_token& stop, const std::function<bool()>& must_end) {
  set(CURLOPT_HTTPHEADER, headers_);
  if (curl_.multi_add_handle(multi_, easy_) != CURLM_OK)
    throw Error(ErrorCode::internal, "libcurl cannot begin a call.");
  CURLcode result = CURLE_OK;
  {
    const std::stop_callback wake(stop, [this] { curl_.multi_wakeup(multi_); });
    result = perform(stop, must_end);
  }
  curl_.multi_remove_handle(multi_, easy_);
  return result;
}

long Transfer::status() const {
  long status = 0;
  curl_.easy_getinfo(easy_, CURLINFO_RESPONSE_CODE, &status);
  return status;
}

std::chrono::seconds Transfer::retry_after() const {
  curl_off_t seconds = 0;
  curl_.easy_getinfo(easy_, CURLINFO_RETRY_AFTER, &seconds);
  return std::chrono::seconds(seconds);
}

std::int64_t Transfer::declared_bytes() const {
  curl_off_t bytes = -1;
  curl_.easy_getinfo(easy_, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &bytes);
  return bytes;
}

std::string resolve_location(const OutboundUrl& from, const std::string& location) {
  const CurlLibrary& curl = CurlLibrary::loaded();
  const std::unique_ptr<CURLU, FreeUrl> url(curl.url(), FreeUrl{curl});
  const std::string base = scheme_of(from) + "://" + in_brackets(from.host) + ":" +
                           std::to_string(from.port) + from.target;
  char* text = nullptr;
  const bool is_url =
      url && curl.url_set(url.get(), CURLUPART_URL, base.c_str(), CURLU_URLENCODE) == CURLUE_OK &&
      curl.url_set(url.get(), CURLUPART_URL, location.c_str(), CURLU_URLENCODE) == CURLUE_OK &&
      curl.url_set(url.get(), CURLUPART_FRAGMENT, nullptr, 0) == CURLUE_OK &&
      curl.url_get(url.get(), CURLUPART_URL, &text, 0) == CURLUE_OK;
  if (!is_url) return {};
  std::string resolved(text);
  curl.free(text);
  return resolved;
}

}  // namespace unwrapd::server::outbound
