#pragma once
// Requests and answers as plain values. Handlers see no socket and no HTTP library, so that they
// can be read, and tested, without either.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/error.hpp"
#include "server/base/files.hpp"

namespace unwrapd::server::http {

/// A part of a multipart/form-data body.
struct Part {
  std::string name;
  std::string filename;
};

/// The body of a request, handed over in pieces as it arrives. Read it once, or not at all.
/// Throws Error: body_too_large, request_timeout, malformed_request.
class BodyReader {
 public:
  using Sink = std::function<void(std::string_view bytes)>;
  using PartStart = std::function<void(const Part& part)>;

  BodyReader() = default;
  BodyReader(const BodyReader&) = delete;
  BodyReader& operator=(const BodyReader&) = delete;
  virtual ~BodyReader() = default;

  virtual void read(const Sink& sink) = 0;
  /// Calls start before the bytes of each part.
  virtual void read_parts(const PartStart& start, const Sink& sink) = 0;
};

struct IgnoreCase {
  using is_transparent = void;
  bool operator()(std::string_view left, std::string_view right) const;
};

/// Whether the client has closed its connection meanwhile; empty if that is not known.
using HasLeft = std::function<bool()>;

/// Limits of one caller; 0: no limit.
struct Quota {
  std::int64_t max_jobs = 0;   ///< queued or running
  std::int64_t max_bytes = 0;  ///< of the files of all jobs
};

/// On whose behalf a request is made. Without API keys all callers are the same one, without
/// limits.
struct Caller {
  std::string owner;     ///< id of the API key; empty without one
  bool sees_all = true;  ///< the jobs of others, too
  Quota quota;
  std::string key_sha256 = {};  ///< of the API key; signed links end with the key
};

/// Allows its bearer, who needs no API key, to send one job for the holder of a key.
struct Ticket {
  std::string id;
  std::int64_t max_bytes = 0;  ///< of the upload
  std::int64_t expires = 0;    ///< seconds since 1970
};

struct Request {
  std::string method;
  std::string path;  ///< percent-decoded
  std::multimap<std::string, std::string> query;
  std::multimap<std::string, std::string, IgnoreCase> headers;
  std::string id;                               ///< the {id} of the path, once a route has matched
  std::string sha256;                           ///< the {sha256} of the path, the same
  Caller caller;                                ///< set before the handler runs
  std::optional<Ticket> ticket = std::nullopt;  ///< by which it came, set with the caller
  std::string client;                           ///< the address of the client
  std::string host;            ///< by which the server was reached, with its port; may be empty
  BodyReader* body = nullptr;  ///< of POST, PUT and PATCH
  std::int64_t declared_bytes = 0;              ///< of the body, decoded; 0 when not declared
  std::optional<Error> refusal = std::nullopt;  ///< why its head is refused; this is the answer
  HasLeft has_left = {};

  /// The headers of this name as one list (RFC 9110, 5.3), one that repeats the one before left
  /// out; empty when there is none.
  [[nodiscard]] std::string header(std::string_view name) const;
};

/// Bytes of a file, sent as they are read.
struct FileBody {
  std::shared_ptr<const File> file;
  std::int64_t offset = 0;
  std::int64_t length = 0;
  bool gzip = false;  ///< compressed as it is sent
};

struct StreamPiece {
  std::string bytes;  ///< empty when there is nothing new
  bool end = false;   ///< nothing will follow
};

/// A body that comes over time. Its producer rings HttpUses::news when next() has more.
struct StreamBody {
  std::function<StreamPiece()> next;  ///< what there is now, a few kB at most; never waits
  std::string_view ping = {};         ///< sent after a silence; outlives the body
};

struct Response {
  int status = 200;
  std::string content_type;
  std::vector<std::pair<std::string, std::string>> headers;
  std::variant<std::string, FileBody, StreamBody> body;
  std::string_view route;    ///< the path of the route that answered, "" for none
  std::string_view problem;  ///< the code of an error, else ""
};

using Handler = std::function<Response(const Request&)>;

/// A request and its answer, for the log and the metrics.
struct Exchanged {
  std::string method;  ///< "" when the request could not be read
  std::string path;
  std::string client;
  std::string_view route;
  std::string_view problem;
  int status = 0;
  std::int64_t received_bytes = 0;  ///< of the body
  std::int64_t sent_bytes = 0;
  double seconds = 0;
};
using Observer = std::function<void(const Exchanged&)>;

/// Without spaces and tabs at its ends (OWS of RFC 9110, 5.6.3).
std::string_view trim(std::string_view text);

/// Whether two names are equal but for the case of their letters.
bool same_word(std::string_view left, std::string_view right);

/// A control character other than a tab, which no field may hold (RFC 9110, 5.5).
constexpr bool is_control(char c) { return (c >= 0 && c < ' ' && c != '\t') || c == '\x7f'; }

/// An answer with a JSON body.
Response json_response(int status, std::string_view json);
/// One that no cache may store: what it tells may change at any time.
Response uncached_json_response(int status, std::string_view json);

/// The problem document of an error, with Retry-After for RetryLater.
Response error_response(const Error& error, std::string_view job = {});

}  // namespace unwrapd::server::http
