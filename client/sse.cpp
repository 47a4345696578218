// The event stream format of the HTML standard (section "Server-sent events"), as far as a server
// that ends its lines with LF or CRLF needs: a lone CR as a line end is not known here.
#include "client/sse.hpp"

#include "client/failure.hpp"

namespace unwrapd::client {
namespace {

constexpr std::size_t kMostEvent = std::size_t{16} << 20;

}  // namespace

void SseParser::feed(std::string_view bytes, const Sink& sink) {
  for (std::size_t newline = bytes.find('\n'); newline != std::string_view::npos;
       newline = bytes.find('\n')) {
    line_.append(bytes.substr(0, newline));
    bytes.remove_prefix(newline + 1);
    if (line_.ends_with('\r')) line_.pop_back();
    take_line(line_, sink);
    line_.clear();
  }
  line_.append(bytes);
  if (line_.size() + event_.data.size() > kMostEvent)
    throw Failure(ExitCode::unreachable, "An event of the server has no end; check the address.");
}

void SseParser::take_line(std::string_view line, const Sink& sink) {
  if (line.starts_with(':')) return;  // a comment: the server's heartbeat
  if (!line.empty()) {
    const std::size_t colon = line.find(':');
    std::string_view value =
        colon == std::string_view::npos ? std::string_view() : line.substr(colon + 1);
    if (value.starts_with(' ')) value.remove_prefix(1);
    take_field(line.substr(0, colon), value);
    return;
  }
  if (has_data_) {
    if (event_.name.empty()) event_.name = "message";
    sink(event_);
  }
  event_.name.clear();
  event_.data.clear();
  has_data_ = false;
}

void SseParser::take_field(std::string_view name, std::string_view value) {
  if (name == "id") event_.id = value;
  if (name == "event") event_.name = value;
  if (name == "data") {
    if (has_data_) event_.data += '\n';
    event_.data += value;
    has_data_ = true;
  }
}

}  // namespace unwrapd::client
