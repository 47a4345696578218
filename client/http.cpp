// The one file of the client that knows the HTTP library. A stop request shuts the socket down from
// the requesting thread, so that a read that waits for the next event returns at once.
#include "client/http.hpp"

#include <httplib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>

#include "client/failure.hpp"

namespace unwrapd::client {
namespace {

constexpr int kConnectSeconds = 5;
constexpr int kSilenceSeconds = 60;  // event streams send a heartbeat every 15 s
constexpr std::size_t kBlockBytes = 65'536;

httplib::Client connection(const ServerUrl& server) {
  httplib::Client client(server.origin);
  client.set_connection_timeout(kConnectSeconds);
  client.set_read_timeout(kSilenceSeconds);
  client.set_write_timeout(kSilenceSeconds);
  client.set_tcp_nodelay(true);
  // From the environment alone: a command line is seen by everybody on the machine.
  if (const char* key = std::getenv("UNWRAP_API_KEY")) client.set_bearer_token_auth(key);
  return client;
}

httplib::Headers to_httplib(const Headers& headers) { return {headers.begin(), headers.end()}; }

Headers lower_case(const httplib::Headers& headers) {
  Headers lowered;
  for (const auto& [name, value] : headers) {
    std::string key = name;
    std::ranges::transform(key, key.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    lowered.emplace(std::move(key), value);
  }
  return lowered;
}

/// Runs a callback for the library, which knows no exceptions: keeps what was thrown for later.
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

/// Sends one request with the stop token watching it; guard is that of its callbacks.
template <class Send>
httplib::Result perform(const ServerUrl& server, const std::stop_token& stop, const Guard& guard,
                        Send&& send) {
  httplib::Client client = connection(server);
  const std::stop_callback on_stop(stop, [&] { client.stop(); });
  if (stop.stop_requested()) throw Failure(ExitCode::interrupted, "Stopped.");
  httplib::Result result = send(client);
  guard.rethrow();
  if (stop.stop_requested()) throw Failure(ExitCode::interrupted, "Stopped.");
  if (!result)
    throw Failure(ExitCode::unreachable, "The server at " + server.origin + " gave no answer (" +
                                             httplib::to_string(result.error()) +
                                             "); start it, or name another with --server.");
  return result;
}

/// Hands the library the next block of an upload.
void send_block(UploadReader& reader, std::size_t length, httplib::DataSink& sink) {
  std::array<char, kBlockBytes> block;
  const std::size_t count = reader.read(block.data(), std::min(length, block.size()));
  sink.write(block.data(), count);
}

/// Where the body of an answer goes: to the caller's sink when it is a success, else into text.
struct Receiver {
  const BytesSink& sink;
  bool to_sink = false;
  std::string text;

  void begin(int status) { to_sink = sink && status >= 200 && status < 300; }
  void take(std::string_view bytes) {
    if (to_sink) {
      sink(bytes);
    } else {
      text += bytes;
    }
  }
};

Reply to_reply(const httplib::Result& result) {
  return {result->status, lower_case(result->headers), result->body};
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
  const auto send = [&](httplib::Client& client) {
    return client.Post(server_.prefix + path, to_httplib(headers), upload.bytes(), next_block,
                       upload.content_type);
  };
  return to_reply(perform(server_, stop_, guard, send));
}

Reply Http::get(const std::string& path, const Headers& headers, const BytesSink& sink) const {
  Receiver receiver{.sink = sink, .text = {}};
  const auto on_head = [&](const httplib::Response& response) {
    receiver.begin(response.status);
    return !stop_.stop_requested();
  };
  Guard guard;
  const auto on_bytes = [&](const char* data, std::size_t length) {
    return !stop_.stop_requested() && guard([&] { receiver.take({data, length}); });
  };
  const auto send = [&](httplib::Client& client) {
    return client.Get(server_.prefix + path, to_httplib(headers), on_head, on_bytes);
  };
  Reply reply = to_reply(perform(server_, stop_, guard, send));
  reply.body = std::move(receiver.text);
  return reply;
}

Reply Http::remove(const std::string& path) const {
  const auto send = [&](httplib::Client& client) { return client.Delete(server_.prefix + path); };
  return to_reply(perform(server_, stop_, {}, send));
}

}  // namespace unwrapd::client
