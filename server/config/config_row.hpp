#pragma once
// One option of the server, and how each kind of value is read from text and told as text. A row
// names a member of Config by its path: number(heading, {1, 256}, &Config::limits,
// &api::Limits::max_queue).
//
// Rejected: values bound to CLI11's options. It lets a file win over the environment, cuts quoted
// values at '#', and says of a wrong value neither where it came from nor what would be right.

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "server/config/config.hpp"

namespace unwrapd::server::config {

/// A switch is a flag that may go without a value, which is then "true".
enum class ConfigKind { number, text, on_off, switch_of_text, list };

/// What an option is called and said to do.
struct ConfigHeading {
  std::string_view name;   ///< "max-queue"
  std::string_view takes;  ///< "N": the form of the value, in --help
  std::string_view what;   ///< a line of --help
  bool is_secret = false;  ///< never printed
};

struct ConfigRow {
  ConfigHeading heading;
  ConfigKind kind = ConfigKind::text;
  /// Throws Error{invalid_option} whose message is what would be right: "a number from 1 to 256".
  std::function<void(Config& config, const std::string& text)> set;
  std::function<std::string(const Config& config)> get;
};

/// The rows in the order of --help and --print-config.
struct ConfigGroup {
  std::string_view title;
  std::vector<ConfigRow> rows;
};
std::vector<ConfigGroup> config_groups();
/// Three of them (storage_table.cpp, access_table.cpp).
ConfigGroup storing();
ConfigGroup admitting();
ConfigGroup calling_out();

/// What rows cannot see each by itself. Throws Error{invalid_option} naming the options.
void check_together(const Config& config);

/// The most of what is counted by an int.
inline constexpr std::int64_t kMaxCount = std::numeric_limits<std::int32_t>::max();

struct Range {
  std::int64_t least = 0;
  std::int64_t most = 0;
};

/// The number that text is, within range. Throws as ConfigRow::set does.
std::int64_t number_in(Range range, const std::string& text);
/// "true" and "false". Throws as ConfigRow::set does.
bool on_or_off(const std::string& text);
/// The trimmed, non-empty pieces between commas.
std::vector<std::string> split_list(const std::string& text);
std::string join_list(const std::vector<std::string>& items);
[[noreturn]] void expected(const std::string& what);

/// The member of config at this path.
template <class SomeConfig, class... Path>
auto& member(SomeConfig& config, Path... path) {
  return (config.*....*path);
}

template <class... Path>
ConfigRow number(const ConfigHeading& heading, Range range, Path... path) {
  return {.heading = heading,
          .kind = ConfigKind::number,
          .set =
              [=](Config& config, const std::string& text) {
                auto& value = member(config, path...);
                value = static_cast<std::decay_t<decltype(value)>>(number_in(range, text));
              },
          .get = [=](const Config& config) { return std::to_string(member(config, path...)); }};
}

/// A std::string or a path.
template <class... Path>
ConfigRow text(const ConfigHeading& heading, Path... path) {
  return {.heading = heading,
          .kind = ConfigKind::text,
          .set = [=](Config& config, const std::string& value) { member(config, path...) = value; },
          .get = [=](const Config& config) { return std::string(member(config, path...)); }};
}

/// A flag without a value; true or false elsewhere.
template <class... Path>
ConfigRow on_off(const ConfigHeading& heading, Path... path) {
  return {.heading = heading,
          .kind = ConfigKind::on_off,
          .set = [=](Config& config,
                     const std::string& value) { member(config, path...) = on_or_off(value); },
          .get =
              [=](const Config& config) {
                return std::string(member(config, path...) ? "true" : "false");
              }};
}

/// A std::vector<std::string>, told with commas; an array in the file. check throws as
/// ConfigRow::set does when an item is wrong.
template <class... Path>
ConfigRow list(const ConfigHeading& heading, void (*check)(const std::string& item), Path... path) {
  return {.heading = heading,
          .kind = ConfigKind::list,
          .set =
              [=](Config& config, const std::string& value) {
                std::vector<std::string> items = split_list(value);
                for (const std::string& item : items) check(item);
                member(config, path...) = std::move(items);
              },
          .get = [=](const Config& config) { return join_list(member(config, path...)); }};
}

template <class Value>
using Names = std::vector<std::pair<std::string_view, Value>>;

/// One of a few names.
template <class Value, class... Path>
ConfigRow choice(const ConfigHeading& heading, const Names<Value>& names, Path... path) {
  return {.heading = heading,
          .kind = ConfigKind::text,
          .set =
              [=](Config& config, const std::string& value) {
                std::string all;
                for (const auto& [name, meaning] : names) {
                  if (name == value) return void(member(config, path...) = meaning);
                  all += (all.empty() ? "" : ", ") + std::string(name);
                }
                expected("one of " + all);
              },
          .get =
              [=](const Config& config) {
                for (const auto& [name, meaning] : names)
                  if (meaning == member(config, path...)) return std::string(name);
                return std::string();
              }};
}

}  // namespace unwrapd::server::config
