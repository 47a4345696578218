#include "server/config/env_typos.hpp"

#include <algorithm>
#include <array>

namespace unwrapd::server::config {
namespace {

constexpr std::string_view kPrefix = "UNWRAPD_";
/// Variables of the command `unwrap`, of ./dev, of the tests and of the script of the container.
constexpr std::array<std::string_view, 8> kOthers = {
    "UNWRAPD_SERVER", "UNWRAPD_BIN",   "UNWRAPD_COMMIT", "UNWRAPD_DEBIAN",
    "UNWRAPD_ENGINE", "UNWRAPD_IMAGE", "UNWRAPD_JOBS",   "UNWRAPD_TEST_DATA"};

/// Kubernetes and Docker describe a service "unwrapd" by UNWRAPD_SERVICE_HOST, UNWRAPD_PORT
/// ("tcp://10.0.0.1:8080") and UNWRAPD_PORT_8080_TCP.
bool tells_of_a_service(std::string_view name, std::string_view value) {
  name.remove_prefix(kPrefix.size());
  return name.starts_with("SERVICE_HOST") || name.starts_with("SERVICE_PORT") ||
         (name.starts_with("PORT") && value.find("://") != std::string_view::npos) ||
         (name.starts_with("PORT_") && name.find("_TCP") != std::string_view::npos);
}

std::string nearest_of(std::string_view name, const std::vector<std::string>& known) {
  const auto distance = [&](const std::string& one) { return spelling_distance(name, one); };
  return *std::ranges::min_element(known, {}, distance);
}

}  // namespace

std::optional<std::string> unknown_variable(const char* const* environment,
                                            const std::vector<std::string>& known) {
  for (; *environment != nullptr; ++environment) {
    const std::string_view entry = *environment;
    const std::string_view name = entry.substr(0, entry.find('='));
    const std::string_view value = entry.substr(std::min(name.size() + 1, entry.size()));
    if (!name.starts_with(kPrefix) || std::ranges::count(known, name) > 0 ||
        std::ranges::count(kOthers, name) > 0 || tells_of_a_service(name, value))
      continue;
    return "there is no variable " + std::string(name) + "; did you mean " +
           nearest_of(name, known) + "?";
  }
  return std::nullopt;
}

/// Optimal string alignment: rows of the table are left's first i letters, columns right's first j.
std::size_t spelling_distance(std::string_view left, std::string_view right) {
  const std::size_t columns = right.size() + 1;
  std::vector<std::size_t> table((left.size() + 1) * columns);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& {
    return table[i * columns + j];
  };
  for (std::size_t i = 0; i <= left.size(); ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      if (i == 0 || j == 0) {
        at(i, j) = i + j;
        continue;
      }
      const std::size_t change = left[i - 1] == right[j - 1] ? 0 : 1;
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, at(i - 1, j - 1) + change});
      const bool swapped =
          i > 1 && j > 1 && left[i - 1] == right[j - 2] && left[i - 2] == right[j - 1];
      if (swapped) at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return at(left.size(), right.size());
}

}  // namespace unwrapd::server::config
