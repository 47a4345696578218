#include "server/base/clock.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>

namespace unwrapd::server {

std::int64_t now_ms() {
  using std::chrono::system_clock;
  const auto since_epoch = system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_epoch).count();
}

std::int64_t elapsed_ms() {
  using std::chrono::steady_clock;
  const auto since_boot = steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_boot).count();
}

namespace {

/// The random id that Linux makes at every boot; empty where it cannot be read.
std::string read_boot() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string boot;
  std::getline(file, boot);
  return boot;
}

}  // namespace

Times read_clocks() {
  static const std::string boot = read_boot();
  constexpr std::int64_t kLongestMs = 1000;  // this process may be held between any two reads
  while (true) {
    const std::int64_t before_ms = elapsed_ms();
    const std::int64_t of_day_ms = now_ms();
    const std::int64_t after_ms = elapsed_ms();
    if (after_ms - before_ms < kLongestMs) return {of_day_ms, after_ms, boot};
  }
}

std::string rfc3339(std::int64_t epoch_ms) {
  const std::time_t seconds = epoch_ms / 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 64> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  const int milliseconds = static_cast<int>(epoch_ms % 1000);
  const int rest =
      std::snprintf(text.data() + length, text.size() - length, ".%03dZ", milliseconds);
  return {text.data(), length + static_cast<std::size_t>(rest)};
}

}  // namespace unwrapd::server
