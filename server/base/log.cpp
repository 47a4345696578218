#include "server/base/log.hpp"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <array>
#include <string>

#include "server/base/clock.hpp"
#include "server/base/trace.hpp"

namespace unwrapd::server {
namespace {

constexpr std::array kLevelNames = {"debug", "info", "warning", "error"};

/// The first three members bare, the others by name.
std::string text_of(const api::Json& line) {
  std::string text;
  int at = 0;
  for (const auto& [name, value] : line.items()) {
    if (at > 0) text += ' ';
    text += at < 2    ? value.get<std::string>()
            : at == 2 ? api::to_text(value)
                      : name + "=" + api::to_text(value);
    ++at;
  }
  return text;
}

}  // namespace

Log::Log(LogLevel least, LogFormat format)
    : least_(least),
      format_(format),
      lines_(std::make_shared<spdlog::logger>("unwrapd",
                                              std::make_shared<spdlog::sinks::stderr_sink_mt>())) {
  lines_->set_pattern("%v");
  lines_->set_level(spdlog::level::trace);
}

void Log::write(LogLevel level, std::string_view event, const api::Json& fields) const {
  if (level < least_ || level == LogLevel::off) return;
  api::Json line = {{"time", rfc3339(now_ms())},
                    {"level", kLevelNames[static_cast<std::size_t>(level)]},
                    {"event", event}};
  if (!current_trace().empty()) line["trace"] = current_trace();
  if (fields.is_object()) line.update(fields);
  lines_->info("{}", format_ == LogFormat::json ? api::to_text(line) : text_of(line));
}

}  // namespace unwrapd::server
