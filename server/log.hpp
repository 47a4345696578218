#pragma once
// Structured logs: one JSON object a line on stderr. The line is built by the JSON library, so that
// whatever a user sends is escaped; spdlog keeps lines whole between threads.

#include <memory>
#include <string_view>

#include "api/json.hpp"

namespace spdlog {
class logger;
}

namespace unwrapd::server {

enum class LogLevel { debug, info, warning, error, off };

class Log {
 public:
  explicit Log(LogLevel least);

  /// {"time": ..., "level": ..., "event": event, ...fields}; fields is an object or null.
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
  std::shared_ptr<spdlog::logger> lines_;
};

}  // namespace unwrapd::server
