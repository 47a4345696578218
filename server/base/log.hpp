#pragma once
// Structured logs on stderr: a line is one JSON object, or the same as text for the eye. What it
// says is written by the JSON library, so that whatever a user sends is escaped; spdlog keeps lines
// whole between threads. A line of a thread that works for a request tells its trace.

#include <memory>
#include <string_view>

#include "api/json.hpp"

namespace spdlog {
class logger;
}

namespace unwrapd::server {

enum class LogLevel { debug, info, warning, error, off };
enum class LogFormat { json, text };

class Log {
 public:
  explicit Log(LogLevel least, LogFormat format = LogFormat::json);

  /// {"time": ..., "level": ..., "event": event, "trace": ..., ...fields}, or
  /// time level event trace=... field=...; fields is an object or null.
  void write(LogLevel level, std::string_view event, const api::Json& fields = nullptr) const;

  void debug(std::string_view event, const api::Json& fields = nullptr) const {
    write(LogLevel::debug, event, fields);
  }
  void info(std::string_view event, const api::Json& fields = nullptr) const {
    write(LogLevel::info, event, fields);
  }
  void warning(std::string_view event, const api::Json& fields = nullptr) const {
    write(LogLevel::warning, event, fields);
  }
  void error(std::string_view event, const api::Json& fields = nullptr) const {
    write(LogLevel::error, event, fields);
  }

 private:
  LogLevel least_;
  LogFormat format_;
  std::shared_ptr<spdlog::logger> lines_;
};

}  // namespace unwrapd::server
