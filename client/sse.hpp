#pragma once
// Parses server-sent events: takes bytes as they arrive, and returns whole events.

#include <functional>
#include <string>
#include <string_view>

namespace unwrapd::client {

/// name is "message" if the stream names none. id is the last one seen, as the standard says.
struct SseEvent {
  std::string id;
  std::string name;
  std::string data;
};

class SseParser {
 public:
  using Sink = std::function<void(const SseEvent&)>;

  /// Takes the next bytes of the stream, divided anywhere, and passes on each event that they
  /// complete.
  void feed(std::string_view bytes, const Sink& sink);

 private:
  void take_line(std::string_view line, const Sink& sink);
  void take_field(std::string_view name, std::string_view value);

  std::string line_;
  SseEvent event_;
  bool has_data_ = false;
};

}  // namespace unwrapd::client
