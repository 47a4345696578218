// Bytes as they come from a socket, through everything that reads them before a handler does: the
// head's check, the framing of bodies, httplib's parser, the parts of a form.
#include <sys/socket.h>
#include <unistd.h>

#include <array>

#include "api/json.hpp"
#include "api/options.hpp"
#include "core/base/error.hpp"
#include "server/base/identity.hpp"
#include "server/http/connection.hpp"
#include "server/http/http_exchange.hpp"
#include "server/http/http_head.hpp"
#include "server/outbound/outbound_url.hpp"
#include "server/uploads/mesh_reference.hpp"
#include "tests/fuzz/targets.hpp"

namespace unwrapd::fuzz {
namespace {

constexpr std::int64_t kMaxBytes = std::int64_t{64} * 1024;  // what a socket takes unread

void head(std::string_view bytes) {
  const std::string whole = std::string(bytes.substr(0, bytes.find("\r\n\r\n"))) + "\r\n\r\n";
  const server::http::Framing framing = server::http::vet_head(whole);
  promise(framing.content_length >= 0, "a length is no less than 0");
  promise(!framing.chunked || framing.content_length == 0, "a body has one length");
  std::string plain = whole;
  const std::ptrdiff_t shorter = server::http::simplify(plain, framing);
  promise(std::ssize(plain) == std::ssize(whole) - shorter, "a head is as long as it says");
  promise(plain.at(framing.target) == '/', "a target is a path then");
  const server::http::Framing again = server::http::vet_head(plain);
  promise(again.authority == 0 && again.content_length == framing.content_length &&
              again.chunked == framing.chunked,
          "and nothing else has changed");
}

std::vector<std::string> head_seeds() {
  return {
      "GET /v1/jobs?a=b HTTP/1.1\r\nHost: x\r\nAccept: */*\r\n",
      "POST /v1/jobs HTTP/1.1\r\nHost: x\r\nContent-Length: 12\r\nExpect: 100-continue\r\n",
      "GET http://[::1]:80?a=b HTTP/1.1\r\nHost: x\r\n",
      "PUT / HTTP/1.0\r\nRange: x\r\nTransfer-Encoding: chunked\r\nContent-Encoding: identity\r\n"};
}

/// Reads a request whole, as the handlers of uploads do. No more can come out than went in.
server::http::Response swallow(const server::http::Request& request, std::size_t sent) {
  std::size_t got = 0;
  const server::http::BodyReader::Sink count = [&](std::string_view piece) { got += piece.size(); };
  try {
    const auto type = request.headers.find("Content-Type");
    const bool parts = type != request.headers.end() && type->second.starts_with("multipart/");
    if (request.body != nullptr && parts)
      request.body->read_parts([&](const server::http::Part& part) { got += part.name.size(); },
                               count);
    else if (request.body != nullptr)
      request.body->read(count);
  } catch (const Error& error) {
    return server::http::error_response(error);
  }
  promise(got <= sent, "a body is no longer than what was sent");
  server::http::Response response;
  response.status = 200;
  response.content_type = "text/plain";
  response.body = std::string("ok");
  return response;
}

void connection(std::string_view bytes) {
  bytes = bytes.substr(0, static_cast<std::size_t>(kMaxBytes));
  std::array<int, 2> ends{};
  promise(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends.data()) == 0,
          "there are sockets");
  promise(::send(ends[0], bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()),
          "the socket takes the bytes");
  ::shutdown(ends[0], SHUT_WR);
  {
    const server::Log log(server::LogLevel::off);
    const server::http::HttpUses uses{
        .answer =
            [&](const server::http::Request& request) { return swallow(request, bytes.size()); },
        .observe = [](const server::http::Exchanged& /*done*/) {}};
    server::http::Connection served(
        {.transport = std::make_unique<server::http::Transport>(ends[1])}, -1,
        {.max_body_bytes = kMaxBytes});
    server::http::Exchange exchange(uses, log, std::chrono::seconds(15));
    try {
      while (served.next_request() && exchange.answer_request(served, false)) {
      }
    } catch (const Error&) {  // the connection's refusal; its caller writes it
    }
  }
  ::close(ends[0]);
}

std::vector<std::string> connection_seeds() {
  return {
      "POST http://x/v1/jobs HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\n"
      "Content-Length: 3\r\n\r\nabcGET http://x HTTP/1.1\r\nHost: x\r\n\r\n",
      "GET /v1/limits?x=%41&y HTTP/1.1\r\nHost: x\r\n\r\nGET / HTTP/1.1\r\nHost: x\r\n\r\n",
      "POST /v1/jobs HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
      "5;a=b\r\nhello\r\n0\r\nTrailer: x\r\n\r\n",
      "POST /v1/jobs HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\nhello"};
}

void multipart(std::string_view bytes) {
  connection(
      "POST /v1/jobs HTTP/1.1\r\nHost: x\r\nContent-Type: multipart/form-data; boundary=b\r\n"
      "Content-Length: " +
      std::to_string(bytes.size()) + "\r\n\r\n" + std::string(bytes));
}

std::vector<std::string> multipart_seeds() {
  return {
      "--b\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n{}\r\n"
      "--b\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"m.obj\"\r\n"
      "Content-Type: model/obj\r\n\r\nv 0 0 0\n\r\n--b--\r\n"};
}

void reference(std::string_view bytes) {
  const server::uploads::MeshReference named = server::uploads::parse_mesh_reference(bytes);
  promise(named.sha256.empty() != named.source.empty(), "there is one mesh");
  promise(named.sha256.empty() || server::is_sha256(named.sha256),
          "a stored mesh is named by its digest, which leads nowhere else");
  promise(!named.options ||
              api::parse_json(*named.options, {.max_bytes = api::kMaxOptionsBytes}).is_object(),
          "options are an object");
}

std::vector<std::string> reference_seeds() {
  const std::string digest(64, 'a');
  return {R"({"mesh":")" + digest + R"(","options":{"method":"slim","stop":{"iterations":3}}})",
          R"({"mesh":")" + digest + R"("})", R"({"source":"https://a.example/b.glb","name":"c"})"};
}

/// Addresses that clients chose, as they are read before they are checked.
void address(std::string_view bytes) {
  namespace out = server::outbound;
  const out::OutboundUrl url =
      out::read_url(std::string(bytes), {.refused = ErrorCode::source_refused, .whose = "source"});
  promise(url.port > 0 && url.port < 65'536, "a port is one");
  promise(url.target.starts_with('/'), "a target is a path");
  promise(url.host.find_first_of("@/?#\\ \r\n%") == std::string::npos, "a host is one");
}

std::vector<std::string> address_seeds() {
  return {"https://a.example/b.glb?c=d", "http://[::ffff:10.0.0.1]:8080/x", "https://127.1"};
}

}  // namespace

std::span<const Target> http_targets() {
  static const std::array targets = {Target{"head", head, head_seeds},
                                     Target{"http", connection, connection_seeds},
                                     Target{"multipart", multipart, multipart_seeds},
                                     Target{"reference", reference, reference_seeds},
                                     Target{"address", address, address_seeds},
                                     parking_target()};
  return targets;
}

}  // namespace unwrapd::fuzz
