#include "server/log.hpp"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <array>
#include <string>

#include "server/clock.hpp"

namespace unwrapd::server {
namespace {

constexpr std::array kLevelNames = {"debug", "info", "warning", "error"};

}  // namespace

Log::Log(LogLevel least)
    : least_(least),
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
  if (fields.is_object()) line.update(fields);
  lines_->info("{}", line.dump(-1, ' ', false, api::Json::error_handler_t::replace));
}

}  // namespace unwrapd::server
