#include "server/webhooks/webhook_http.hpp"

#include <openssl/ssl.h>

#include <csignal>
#include <memory>
#include <string_view>

#include "core/base/error.hpp"
#include "server/webhooks/curl_library.hpp"

namespace unwrapd::server::webhooks {
namespace {

constexpr long kConnectSeconds = 5;  // with the handshake of TLS
constexpr long kWholeSeconds = 15;
constexpr int kPollMs = 1000;
constexpr std::size_t kMostStatusLine = 512;
constexpr std::size_t kMostHead = std::size_t{16} * 1024;  // bytes of all heads of an answer
constexpr int kFirstFinalStatus = 200;
constexpr int kGone = 410;

/// The heads of an answer as libcurl tells them, line by line. It goes on for false.
struct Heads {
  const CurlLibrary& curl;
  CURL* handle;
  std::size_t bytes = 0;
  bool is_final = false;  ///< the last one has ended; before it come 100 and 103

  bool wants_more_after(std::string_view line) {
    bytes += line.size();
    if (bytes > kMostHead || (line.starts_with("HTTP/") && line.size() > kMostStatusLine))
      return false;
    if (line != "\r\n" && line != "\n") return true;
    is_final = status() >= kFirstFinalStatus;
    return !is_final;
  }
  [[nodiscard]] long status() const {
    long status = 0;
    curl.easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
    return status;
  }
};

/// libcurl's callback: another count than it gave ends the call.
std::size_t take_line(const char* bytes, std::size_t, std::size_t count, void* heads) {
  return static_cast<Heads*>(heads)->wants_more_after({bytes, count}) ? count : 0;
}

std::size_t take_no_body(const char*, std::size_t, std::size_t, void*) { return 0; }

/// OpenSSL's own places of certificates, which SSL_CERT_FILE and SSL_CERT_DIR change.
CURLcode trust_the_system(CURL*, void* context, void*) {
  const bool is_set = SSL_CTX_set_default_verify_paths(static_cast<SSL_CTX*>(context)) == 1;
  return is_set ? CURLE_OK : CURLE_SSL_CACERT_BADFILE;
}

std::string in_brackets(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

/// One call: its handles and lists live as long.
class Transfer {
 public:
  explicit Transfer(const WebhookCall& call) : Transfer() {
    set_place(call);
    set_request(call);
    set_limits();
  }
  Transfer(const Transfer&) = delete;
  Transfer& operator=(const Transfer&) = delete;
  ~Transfer() {
    curl_.multi_cleanup(multi_);
    curl_.easy_cleanup(easy_);
    for (curl_slist* list : {headers_, connect_to_}) curl_.slist_free_all(list);
  }

  WebhookAnswer run(const std::stop_token& stop);

 private:
  Transfer() = default;
  /// An option that is not taken might be one that protects.
  template <class Value>
  void set(CURLoption option, Value value) {
    if (curl_.easy_setopt(easy_, option, value) != CURLE_OK)
      throw Error(ErrorCode::internal, "libcurl does not know an option of webhooks.");
  }
  void append(curl_slist*& list, const std::string& text);
  void set_place(const WebhookCall& call);
  void set_request(const WebhookCall& call);
  void set_limits();
  CURLcode perform(const std::stop_token& stop);
  [[nodiscard]] WebhookAnswer answer(CURLcode result) const;

  const CurlLibrary& curl_ = CurlLibrary::loaded();
  CURL* easy_ = curl_.easy_init();
  CURLM* multi_ = curl_.multi_init();
  curl_slist* headers_ = nullptr;
  curl_slist* connect_to_ = nullptr;
  Heads heads_{.curl = curl_, .handle = easy_};
};

void Transfer::append(curl_slist*& list, const std::string& text) {
  curl_slist* const longer = curl_.slist_append(list, text.c_str());
  if (longer == nullptr) throw std::bad_alloc();
  list = longer;
}

/// Whatever libcurl makes of the host's name, it connects to the address that was checked.
void Transfer::set_place(const WebhookCall& call) {
  const std::string port = std::to_string(call.url.port);
  const std::string scheme = call.url.is_https ? "https" : "http";
  set(CURLOPT_URL, (scheme + "://" + in_brackets(call.url.host) + ":" + port + "/").c_str());
  set(CURLOPT_REQUEST_TARGET, call.url.target.c_str());
  append(connect_to_, "::" + in_brackets(call.address) + ":" + port);
  set(CURLOPT_CONNECT_TO, connect_to_);
  set(CURLOPT_PROTOCOLS_STR, scheme.c_str());
  set(CURLOPT_PROXY, "");  // none of the environment's
  set(CURLOPT_FOLLOWLOCATION, 0L);
  set(CURLOPT_CAINFO, nullptr);
  set(CURLOPT_CAPATH, nullptr);
  set(CURLOPT_SSL_CTX_FUNCTION, &trust_the_system);
  set(CURLOPT_SSLVERSION, long{CURL_SSLVERSION_TLSv1_2});
}

void Transfer::set_request(const WebhookCall& call) {
  for (const auto& [name, value] : call.headers) append(headers_, name + ": " + value);
  append(headers_, "Content-Type: application/json");
  append(headers_, "Connection: close");
  append(headers_, "Expect:");
  set(CURLOPT_HTTPHEADER, headers_);
  set(CURLOPT_USERAGENT, "unwrapd/" UNWRAPD_VERSION);
  set(CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_1_1});
  set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(call.body.size()));
  set(CURLOPT_POSTFIELDS, call.body.c_str());
}

void Transfer::set_limits() {
  set(CURLOPT_NOSIGNAL, 1L);
  set(CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
  set(CURLOPT_TIMEOUT, kWholeSeconds);
  set(CURLOPT_HEADERFUNCTION, &take_line);
  set(CURLOPT_HEADERDATA, &heads_);
  set(CURLOPT_WRITEFUNCTION, &take_no_body);
}

CURLcode Transfer::perform(const std::stop_token& stop) {
  int running = 1;
  while (running > 0 && !stop.stop_requested()) {
    if (curl_.multi_perform(multi_, &running) != CURLM_OK) return CURLE_FAILED_INIT;
    if (running > 0) curl_.multi_poll(multi_, nullptr, 0, kPollMs, nullptr);
  }
  int left = 0;
  const CURLMsg* const ended = curl_.multi_info_read(multi_, &left);
  return ended == nullptr ? CURLE_ABORTED_BY_CALLBACK : ended->data.result;
}

WebhookAnswer Transfer::run(const std::stop_token& stop) {
  if (curl_.multi_add_handle(multi_, easy_) != CURLM_OK)
    throw Error(ErrorCode::internal, "libcurl cannot begin a call.");
  CURLcode result = CURLE_OK;
  {
    const std::stop_callback wake(stop, [this] { curl_.multi_wakeup(multi_); });
    result = perform(stop);
  }
  curl_.multi_remove_handle(multi_, easy_);
  return answer(result);
}

WebhookAnswer Transfer::answer(CURLcode result) const {
  if (!heads_.is_final)
    return {.failure = std::string("no answer: ") + curl_.easy_strerror(result)};
  const long status = heads_.status();
  if (status >= 200 && status < 300) return {};
  curl_off_t seconds = 0;
  curl_.easy_getinfo(easy_, CURLINFO_RETRY_AFTER, &seconds);
  return {.failure = "status " + std::to_string(status),
          .is_gone = status == kGone,
          .retry_after = std::chrono::seconds(seconds)};
}

/// OpenSSL writes to a connection that is closed, and libcurl leaves signals to us.
void block_sigpipe() {
  sigset_t pipes;
  sigemptyset(&pipes);
  sigaddset(&pipes, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipes, nullptr);  // of this thread, which has no other use for it
}

}  // namespace

WebhookAnswer post_webhook(const WebhookCall& call, const std::stop_token& stop) {
  block_sigpipe();
  return Transfer(call).run(stop);
}

}  // namespace unwrapd::server::webhooks
