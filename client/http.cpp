// The only file of the client that uses the HTTP library. A stop request shuts the socket down from
// the requesting thread, so that a read that waits for the next event returns at once.
#include "client/http.hpp"

#include <httplib.h>

#include <algorithm>
#include <array>
#include <exception>

#include "client/bounded_http.hpp"
#include "client/failure.hpp"
#include "client/http_redirect.hpp"
#include "core/base/lower_case.hpp"

namespace unwrapd::client {
namespace {

constexpr int kConnectSeconds = 5;
constexpr int kMostRedirects = 5;
constexpr int kSilenceSeconds = 60;  // event streams send a heartbeat every 15 s
constexpr std::size_t kBlockBytes = 65'536;
constexpr std::size_t kMostText = std::size_t{64}
                                  << 20;  // of an answer that is collected in memory
constexpr std::string_view kPlain = "http://", kTls = "https://";

template <class Client>
void prepare(Client& client, const std::string& key) {
  client.set_connection_timeout(kConnectSeconds);
  client.set_read_timeout(kSilenceSeconds);
  client.set_write_timeout(kSilenceSeconds);
  client.set_tcp_nodelay(true);
  if (!key.empty()) client.set_bearer_token_auth(key);
}

/// "host:port", the host in brackets or not, the port given or not.
std::pair<std::string, int> host_and_port(std::string_view authority, const char* usual_port) {
  const std::size_t end = authority.starts_with('[') ? authority.find(']') : authority.find(':');
  const std::size_t colon = authority.find(':', std::min(end, authority.size()));
  std::string host(authority.substr(0, colon));
  if (host.starts_with('[')) host = host.substr(1, host.size() - 2);
  const std::string port(colon == std::string_view::npos ? usual_port
                                                         : authority.substr(colon + 1));
  return {host, std::stoi(port)};
}

httplib::Headers to_httplib(const Headers& headers) { return {headers.begin(), headers.end()}; }

/// With their names in lower case.
Headers from_httplib(const httplib::Headers& headers) {
  Headers lowered;
  for (const auto& [name, value] : headers) lowered.emplace(lower_case(name), value);
  return lowered;
}

/// Runs a callback of the library, which cannot pass exceptions on: stores the exception for later.
class Guard {
 public:
  template <class Callback>
  bool operator()(Callback&& callback) {
    try {
      callback();
      return true;
    } catch (...) {
      thrown_ = std::current_exception();
      return false;
    }
  }
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  std::exception_ptr thrown_;
};

template <class Client, class Send>
httplib::Result perform(Client&& client, const ServerUrl& server, const std::stop_token& stop,
                        const Guard& guard, Send&& send) {
  prepare(client, server.key);
  const std::stop_callback on_stop(stop, [&] { client.stop(); });
  if (stop.stop_requested()) throw Failure(ExitCode::interrupted, "Stopped.");
  httplib::Result result = send(client);
  guard.rethrow();
  if (stop.stop_requested()) throw Failure(ExitCode::interrupted, "Stopped.");
  if (!result)
    throw Failure(ExitCode::unreachable,
                  "The server at " + server.origin + " gave no answer (" +
                      httplib::to_string(result.error()) +
                      "); start it, name another with --server, or use --local.",
                  true);
  return result;
}

/// Sends one request, which the stop token can end; guard belongs to its callbacks.
template <class Send>
httplib::Result perform(const ServerUrl& server, const std::stop_token& stop, const Guard& guard,
                        Send&& send) {
  const std::string_view origin = server.origin;
  if (origin.starts_with(kPlain)) {
    const auto [host, port] = host_and_port(origin.substr(kPlain.size()), "80");
    return perform(BoundedHttp(host, port), server, stop, guard, send);
  }
  const auto [host, port] = host_and_port(origin.substr(kTls.size()), "443");
  return perform(BoundedHttps(host, port), server, stop, guard, send);
}

/// Gives the library the next block of an upload.
void send_block(UploadReader& reader, std::size_t length, httplib::DataSink& sink) {
  std::array<char, kBlockBytes> block;
  const std::size_t count = reader.read(block.data(), std::min(length, block.size()));
  sink.write(block.data(), count);
}

/// Receives the body of an answer: into the caller's sink if the answer is a success, else into
/// text.
struct Receiver {
  const BytesSink& sink;
  bool to_sink = false;
  std::string text;

  void begin(int status) { to_sink = sink && status >= 200 && status < 300; }
  void take(std::string_view bytes) {
    if (to_sink) {
      sink(bytes);
    } else {
      if (text.size() + bytes.size() > kMostText)
        throw Failure(ExitCode::unreachable, "The server's answer has no end; check the address.");
      text += bytes;
    }
  }
};

Reply to_reply(const httplib::Result& result) {
  return {result->status, from_httplib(result->headers), result->body};
}

}  // namespace

std::string Reply::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? std::string() : found->second;
}

Http::Http(ServerUrl server, std::stop_token stop)
    : server_(std::move(server)), stop_(std::move(stop)) {}

Reply Http::post(const std::string& path, const Upload& upload, const Headers& headers) const {
  UploadReader reader(upload);
  Guard guard;
  const auto next_block = [&](std::size_t, std::size_t length, httplib::DataSink& sink) {
    return guard([&] { send_block(reader, length, sink); });
  };
  Receiver receiver{.sink = {}, .text = {}};
  httplib::Request request;
  request.method = "POST";
  request.path = server_.prefix + path;
  request.headers = to_httplib(headers);
  request.set_header("Content-Type", upload.content_type);
  request.content_length_ = upload.bytes();
  request.content_provider_ = next_block;
  request.content_receiver = [&](const char* data, std::size_t length, std::uint64_t,
                                 std::uint64_t) {
    return guard([&] { receiver.take({data, length}); });
  };
  const auto send = [&](auto& client) { return client.send(request); };
  Reply reply = to_reply(perform(server_, stop_, guard, send));
  reply.body = std::move(receiver.text);
  return reply;
}

Reply Http::get(const std::string& path, const Headers& headers, const BytesSink& sink) const {
  Destination at{.server = server_, .path = path};
  for (int redirects = 0;; ++redirects) {
    Reply reply = get_from(at.server, at.path, headers, sink);
    if (!is_redirect(reply.status)) return reply;
    if (redirects == kMostRedirects)
      throw Failure(ExitCode::unreachable, "The server at " + server_.origin +
                                               " redirects without end; check the address.");
    at = redirected(at.server, reply.header("location"));
  }
}

Reply Http::get_from(const ServerUrl& server, const std::string& path, const Headers& headers,
                     const BytesSink& sink) const {
  Receiver receiver{.sink = sink, .text = {}};
  const auto on_head = [&](const httplib::Response& response) {
    receiver.begin(response.status);
    return !stop_.stop_requested();
  };
  Guard guard;
  const auto on_bytes = [&](const char* data, std::size_t length) {
    return !stop_.stop_requested() && guard([&] { receiver.take({data, length}); });
  };
  const auto send = [&](auto& client) {
    return client.Get(server.prefix + path, to_httplib(headers), on_head, on_bytes);
  };
  Reply reply = to_reply(perform(server, stop_, guard, send));
  reply.body = std::move(receiver.text);
  return reply;
}

Reply Http::remove(const std::string& path) const {
  const auto send = [&](auto& client) { return client.Delete(server_.prefix + path); };
  return to_reply(perform(server_, stop_, {}, send));
}

}  // namespace unwrapd::client
