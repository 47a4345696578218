#pragma once
// The body of a request as its handler reads it.

#include <string>
#include <utility>
#include <vector>

#include "server/http/connection.hpp"
#include "server/http/form.hpp"
#include "server/http/gzip.hpp"

namespace unwrapd::server::http {

/// The body from the connection, decoded: httplib does not read it.
class ConnectionBody final : public BodyReader {
 public:
  ConnectionBody(Connection& connection, std::string boundary)
      : connection_(connection), boundary_(std::move(boundary)) {}

  void read(const Sink& sink) override {
    if (!connection_.framing().gzip) return read_as_sent(sink);
    GzipDecoder decoder(connection_.max_body_bytes(), sink);
    read_as_sent([&](std::string_view bytes) { decoder.feed(bytes); });
    decoder.finish();
  }

  void read_parts(const PartStart& start, const Sink& sink) override {
    FormParser form(boundary_, start, sink);
    read([&](std::string_view bytes) { form.feed(bytes); });
    form.finish();
  }

 private:
  static constexpr std::size_t kBodyPiece = std::size_t{64} * 1024;

  void read_as_sent(const Sink& sink) {
    std::vector<char> piece(kBodyPiece);
    while (true) {
      const std::int64_t got = connection_.read(piece.data(), piece.size());
      if (connection_.failure()) throw Error(*connection_.failure());
      if (got == 0) return;
      sink({piece.data(), static_cast<std::size_t>(got)});
    }
  }

  Connection& connection_;
  const std::string boundary_;
};

}  // namespace unwrapd::server::http
