#include "server/sources/source_exchange.hpp"

#include <algorithm>
#include <array>

#include "core/base/lower_case.hpp"
#include "server/http/media_types.hpp"

namespace unwrapd::server::sources {
namespace {

constexpr long kOk = 200;
constexpr std::array<long, 5> kRedirects = {301, 302, 303, 307, 308};
// Servers know few types of meshes: an ending tells them, too.
constexpr std::array<std::string_view, 7> kEndings = {".glb", ".gltf", ".obj", ".stl",
                                                      ".ply", ".off",  ".zip"};

bool has_mesh_type(const std::string& content_type) {
  try {
    return http::body_kind(content_type) == http::BodyKind::asset;
  } catch (const Error&) {
    return false;
  }
}

bool has_mesh_ending(std::string_view target) {
  const std::string path = lower_case(target.substr(0, target.find('?')));
  return std::ranges::any_of(kEndings, [&](auto ending) { return path.ends_with(ending); });
}

}  // namespace

Error source_failure(const std::string& what) {
  return {ErrorCode::source_failed, what, kSourcePointer};
}

SourceExchange::SourceExchange(const outbound::OutboundUrl& url, const std::string& address,
                               const ExchangeLimits& limits, const http::BodyReader::Sink& sink)
    : url_(url), limits_(limits), sink_(sink), transfer_(url, address, limits.time_left) {
  transfer_.on_line([this](std::string_view line) { take_line(line); });
  transfer_.on_head([this] { return take_head(); });
  transfer_.on_body([this](std::string_view bytes) { return take_body(bytes); });
}

/// Keeps the fields of the last head that are read here.
void SourceExchange::take_line(std::string_view line) {
  if (line.starts_with("HTTP/")) {
    for (std::string* field : {&type_, &coding_, &location_}) field->clear();
    return;
  }
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return;
  const std::string name = lower_case(line.substr(0, colon));
  std::string_view value = line.substr(colon + 1);
  while (value.ends_with('\n') || value.ends_with('\r')) value.remove_suffix(1);
  const std::string text(http::trim(value));
  if (name == "content-type") type_ = text;
  if (name == "content-encoding") coding_ = lower_case(text);
  if (name == "location") location_ = text;
}

template <class Step>
bool SourceExchange::goes_on(const Step& step) {
  try {
    step();
    return true;
  } catch (...) {
    thrown_ = std::current_exception();
    return false;
  }
}

void SourceExchange::check_size(std::int64_t bytes) const {
  if (bytes <= limits_.max_bytes) return;
  throw Error(ErrorCode::body_too_large,
              "The source is larger than the " + std::to_string(limits_.max_bytes) +
                  " bytes that a mesh may have; name a smaller file.",
              kSourcePointer);
}

void SourceExchange::check_head() const {
  if (!coding_.empty() && coding_ != "identity")
    throw source_failure(
        "The source is sent compressed although nobody asked for that; give an address that "
        "answers with the file itself.");
  if (!has_mesh_type(type_) && !has_mesh_ending(url_.target))
    throw Error(ErrorCode::unsupported_media_type,
                "The source has neither the type nor the ending of a mesh; give the address of a "
                "GLB, glTF, OBJ, STL, PLY, OFF or zip file.",
                kSourcePointer);
  check_size(transfer_.declared_bytes());
}

bool SourceExchange::take_head() {
  const long status = transfer_.status();
  is_redirect_ = std::ranges::find(kRedirects, status) != kRedirects.end() && !location_.empty();
  return status == kOk && goes_on([&] { check_head(); });
}

bool SourceExchange::take_body(std::string_view bytes) {
  return goes_on([&] {
    check_size(bytes_ + static_cast<std::int64_t>(bytes.size()));
    sink_(bytes);
    bytes_ += static_cast<std::int64_t>(bytes.size());
  });
}

Error SourceExchange::failure(CURLcode result) const {
  switch (result) {
    case CURLE_OPERATION_TIMEDOUT:
      return source_failure("The source did not come within the " +
                            std::to_string(limits_.seconds) +
                            " s allowed; name a faster one, or send the bytes.");
    case CURLE_COULDNT_CONNECT:
      return source_failure("The source's host takes no connection; check the address.");
    case CURLE_PEER_FAILED_VERIFICATION:
    case CURLE_SSL_CONNECT_ERROR:
      return source_failure(
          "The source's host cannot be reached by TLS with a certificate that this server trusts; "
          "check the address.");
    case CURLE_PARTIAL_FILE:
    case CURLE_GOT_NOTHING:
    case CURLE_RECV_ERROR:
    case CURLE_SEND_ERROR:
      return source_failure(
          "The source's host ended the connection before the whole file had come; send the "
          "request again, or the bytes.");
    default:
      return source_failure(
          "The source's host does not answer as a server of HTTP should; check the address.");
  }
}

std::string SourceExchange::run() {
  const CURLcode result = transfer_.run({}, limits_.must_end);
  if (thrown_) std::rethrow_exception(thrown_);
  if (is_redirect_) return location_;
  if (transfer_.has_answer() && transfer_.status() != kOk)
    throw source_failure("The source's host answered with the status " +
                         std::to_string(transfer_.status()) +
                         "; give an address that answers with the file.");
  if (result != CURLE_OK) {
    is_unreachable_ = !transfer_.has_answer() &&
                      (result == CURLE_COULDNT_CONNECT || result == CURLE_OPERATION_TIMEDOUT);
    throw failure(result);
  }
  return {};
}

}  // namespace unwrapd::server::sources
