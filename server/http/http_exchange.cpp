#include "server/http/http_exchange.hpp"

#include <httplib.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include "server/base/trace.hpp"
#include "server/base/utf8.hpp"
#include "server/http/connection_body.hpp"
#include "server/http/gzip.hpp"
#include "server/http/media_types.hpp"
#include "server/http/query.hpp"

namespace unwrapd::server::http {
namespace {

constexpr std::int64_t kFilePiece = std::int64_t{256} * 1024;
constexpr int kFirstError = 400;  // of statuses

/// A connection as httplib sees it: heads in, answers out.
class ConnectionStream final : public httplib::Stream {
 public:
  explicit ConnectionStream(Connection& connection) : connection_(connection) {}

  using httplib::Stream::write;
  bool is_readable() const override { return connection_.is_readable(); }
  bool is_writable() const override { return connection_.is_writable(); }
  ssize_t read(char* data, size_t size) override {
    const std::int64_t count = connection_.read(data, size);
    if (connection_.failure()) throw Error(*connection_.failure());  // caught at the router's door
    return count;
  }
  ssize_t write(const char* data, size_t size) override { return connection_.write({data, size}); }
  void get_remote_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  void get_local_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  socket_t socket() const override { return connection_.socket(); }

 private:
  Connection& connection_;
};

bool is_text(const std::multimap<std::string, std::string>& query) {
  return std::ranges::all_of(query, [](const auto& parameter) {
    return is_utf8_text(parameter.first) && is_utf8_text(parameter.second);
  });
}

Request to_request(const httplib::Request& from, const Framing& framing) {
  Request request;
  request.method = from.method;
  request.path = from.path;
  request.query = parse_query(framing.query);
  request.headers.insert(framing.fields.begin(), framing.fields.end());
  if (framing.brings_body) request.headers.erase("Range");  // RFC 9110, 14.2
  request.host = framing.host;
  request.declared_bytes = framing.gzip ? 0 : framing.content_length;
  request.refusal = framing.refusal;
  if (!request.refusal && !is_text(request.query))
    request.refusal.emplace(ErrorCode::malformed_request,
                            "The query is not UTF-8; percent-encode UTF-8.");
  return request;
}

/// The values of all X-Forwarded-For, joined as if they were one field.
std::string forwarded_for(const Request& request) {
  std::string all;
  const auto [first, last] = request.headers.equal_range("X-Forwarded-For");
  for (auto at = first; at != last; ++at) all += (all.empty() ? "" : ",") + at->second;
  return all;
}

/// Its length is not known beforehand, so that it is sent in chunks.
void set_gzip_file(const FileBody& file, const std::string& type, httplib::Response& out) {
  out.set_chunked_content_provider(type, [next = gzip_pieces(file)](size_t,
                                                                    httplib::DataSink& sink) {
    const std::optional<StreamPiece> piece = next();
    if (!piece || (!piece->bytes.empty() && !sink.write(piece->bytes.data(), piece->bytes.size())))
      return false;
    if (piece->end) sink.done();
    return true;
  });
}

void set_file(const FileBody& file, const std::string& type, httplib::Response& out) {
  if (file.gzip) return set_gzip_file(file, type, out);
  if (file.length == 0) return out.set_content(std::string(), type);
  out.set_content_provider(
      static_cast<size_t>(file.length), type,
      [file](size_t offset, size_t length, httplib::DataSink& sink) {
        const auto piece = std::min(static_cast<std::int64_t>(length), kFilePiece);
        const std::string bytes = file.file->read(file.offset + static_cast<std::int64_t>(offset),
                                                  static_cast<std::size_t>(piece));
        return !bytes.empty() && sink.write(bytes.data(), bytes.size());
      });
}

/// Ends before httplib would read the body.
void set_stream(const StreamBody& stream, const std::string& type, std::optional<StreamBody>& begun,
                httplib::Response& out) {
  out.set_chunked_content_provider(type, [stream, &begun](size_t, httplib::DataSink&) {
    begun = stream;
    return false;
  });
}

/// begun: receives the body of a stream once the head is sent.
void put(const Response& response, std::optional<StreamBody>& begun, httplib::Response& out) {
  out.status = response.status;
  for (const auto& [name, value] : response.headers) out.set_header(name.c_str(), value);
  if (const auto* text = std::get_if<std::string>(&response.body)) {
    if (!text->empty()) out.set_content(*text, response.content_type);
  } else if (const auto* file = std::get_if<FileBody>(&response.body)) {
    set_file(*file, response.content_type, out);
  } else {
    set_stream(std::get<StreamBody>(response.body), response.content_type, begun, out);
  }
}

/// Headers of every answer: its type is not to be guessed, and it is not cached by default. A copy
/// with an ETag may be asked for again.
void add_usual_fields(httplib::Response& out) {
  out.set_header("X-Content-Type-Options", "nosniff");
  if (!out.has_header("Cache-Control"))
    out.set_header("Cache-Control", out.status < kFirstError ? "private, no-cache" : "no-store");
}

/// How long a connection may be idle; there is no limit to the requests on it.
std::string kept_alive(std::chrono::milliseconds idle) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(idle);
  return "timeout=" + std::to_string(seconds.count());
}

}  // namespace

class Exchange::Http final : public httplib::Server {
 public:
  Http(const HttpUses& uses, const Log& log, std::chrono::milliseconds idle)
      : uses_(uses), log_(log), kept_(kept_alive(idle)) {
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
      return HandlerResponse::Handled;  // neither its routes nor its readers of bodies see anything
    });
    set_error_handler(
        HandlerWithResponse([this](const auto&, auto& response) { return fill_error(response); }));
    set_exception_handler([this](const auto&, httplib::Response& response, const auto&) {
      log_.error("exception at the HTTP edge");
      send(error_response(Error(ErrorCode::internal, "An internal error occurred.")), response);
    });
    set_post_routing_handler(
        [this](const auto&, httplib::Response& response) { finish(response); });
  }

  bool answer_request(Connection& connection, bool last) {
    began_ = std::chrono::steady_clock::now();
    connection_ = &connection;
    svr_sock_ = connection.socket();  // httplib writes only while it has one
    last_ = last || connection.framing().last || connection.framing().refusal;
    done_ = {};
    done_.client = connection.client();
    bool closed = false;
    ConnectionStream stream(connection);
    const bool written = process_request(stream, false, closed, unframe);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began_;
    done_.seconds = took.count();
    done_.received_bytes = connection.body_bytes();
    done_.sent_bytes = connection.sent_bytes();
    if (!begun_) uses_.observe(done_);
    told_trace_ = current_trace();
    trace_.reset();
    return written && !closed && !last_;
  }

  std::optional<OpenStream> take_stream() {
    if (!begun_) return std::nullopt;
    OpenStream stream{.body = std::move(*begun_),
                      .done = done_,
                      .trace = told_trace_,
                      .began = began_,
                      .last = last_,
                      .chunked = !connection_->framing().version_1_0};
    begun_.reset();
    return stream;
  }

 private:
  void answer(const httplib::Request& from, httplib::Response& out) {
    Request request = to_request(from, connection_->framing());
    ConnectionBody body(*connection_, multipart_boundary(request.header("Content-Type")));
    if (connection_->framing().brings_body) request.body = &body;
    request.has_left = [connection = connection_] { return connection->has_left(); };
    request.client =
        client_behind(connection_->client(), forwarded_for(request), uses_.trusted_proxies);
    const Trace trace = continue_trace(request.header("traceparent"));
    trace_.emplace(trace.id);
    done_.method = request.method;
    done_.path = request.path;
    done_.client = request.client;
    Response response = uses_.answer(request);
    if (!connection_->framing().version_1_0) encode_answer(request, response);
    send(response, out);
    if (connection_->framing().unknown_coding)
      out.set_header("Accept-Encoding", "gzip");  // RFC 9110, 12.5.3
    out.set_header("traceparent", to_traceparent(trace));
  }

  void send(const Response& response, httplib::Response& out) {
    done_.route = response.route;
    done_.problem = response.problem;
    put(response, begun_, out);
    add_usual_fields(out);
    if (out.is_chunked_content_provider_ && connection_->framing().version_1_0) {
      out.is_chunked_content_provider_ = false;  // it ends with the connection
      last_ = true;
    }
  }

  /// httplib must handle neither 100-continue nor encodings.
  static void unframe(httplib::Request& request) {
    for (const char* name : {"Content-Length", "Transfer-Encoding", "Accept-Encoding", "Expect"})
      request.headers.erase(name);
  }

  /// Gives a body to the errors that httplib itself answers with.
  HandlerResponse fill_error(httplib::Response& response) {
    if (!response.body.empty()) return HandlerResponse::Unhandled;
    send(error_response(Error(ErrorCode::malformed_request,
                              "The request cannot be read as HTTP; check the client.")),
         response);
    return HandlerResponse::Handled;
  }

  /// Corrects what httplib has added to the header fields.
  void finish(httplib::Response& response) {
    if (!connection_->is_read()) last_ = true;  // its rest is no request
    const bool kept = response.headers.erase("Keep-Alive") > 0;
    if (last_) {
      response.headers.erase("Connection");
      response.set_header("Connection", "close");
    } else if (kept) {
      response.set_header("Keep-Alive", kept_);
    }
    done_.status = response.status;
    if (response.status == 204 || response.status == 304) response.headers.erase("Content-Length");
  }

  const HttpUses& uses_;
  const Log& log_;
  const std::string kept_;            // the Keep-Alive of answers after which another may come
  Connection* connection_ = nullptr;  // of the request that is being answered
  bool last_ = false;
  std::optional<StreamBody> begun_;
  std::chrono::steady_clock::time_point began_;
  std::string told_trace_;
  Exchanged done_;
  std::optional<TraceScope> trace_;
};

Exchange::Exchange(const HttpUses& uses, const Log& log, std::chrono::milliseconds idle)
    : http_(std::make_unique<Http>(uses, log, idle)) {}

Exchange::~Exchange() = default;

bool Exchange::answer_request(Connection& connection, bool last) {
  return http_->answer_request(connection, last);
}

std::optional<OpenStream> Exchange::take_stream() { return http_->take_stream(); }

}  // namespace unwrapd::server::http
