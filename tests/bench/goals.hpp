#pragma once
// The table of goals: what was asked of a ratio, what one run measured.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::bench {

/// Gigabytes that one thread reads from memory in a second, best of five.
inline double read_bandwidth(double (*seconds_now)()) {
  const std::vector<double> numbers(std::size_t(1) << 26, 1.0);
  double best = 0, sum = 0;
  for (int k = 0; k < 5; ++k) {
    const double start = seconds_now();
    double part[8] = {};
    for (std::size_t i = 0; i < numbers.size(); i += 8)
      for (std::size_t j = 0; j < 8; ++j) part[j] += numbers[i + j];
    best = std::max(best, 8e-9 * static_cast<double>(numbers.size()) / (seconds_now() - start));
    sum += std::accumulate(part, part + 8, 0.0);
  }
  return sum > 0 ? best : 0;
}

inline std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

/// UNWRAPD_COMMIT, which `./dev bench` sets.
inline std::string commit() {
  const char* given = std::getenv("UNWRAPD_COMMIT");
  return given != nullptr ? given : "unknown";
}

class Goals {
 public:
  Goals() {
    std::printf("%s, commit %s\n%-66s %8s %9s\n", processor().c_str(), commit().c_str(), "goal",
                "asked", "measured");
    json_ << "{\"processor\": \"" << processor() << "\", \"commit\": \"" << commit()
          << "\", \"goals\": [";
  }

  void at_least(std::string_view name, double asked, double measured) {
    add(name, ">=", asked, measured, measured >= asked);
  }
  void at_most(std::string_view name, double asked, double measured) {
    add(name, "<=", asked, measured, measured <= asked);
  }

  [[nodiscard]] std::string json() const { return json_.str() + "\n]}\n"; }

 private:
  void add(std::string_view name, const char* relation, double asked, double measured,
           bool is_met) {
    std::printf("%-66s %2s %5.4g %9.3g%s\n", std::string(name).c_str(), relation, asked, measured,
                is_met ? "" : "   short");
    std::fflush(stdout);
    json_ << (is_first_ ? "\n" : ",\n") << "{\"goal\": \"" << name << "\", \"relation\": \""
          << relation << "\", \"asked\": " << asked << ", \"measured\": " << measured
          << ", \"met\": " << (is_met ? "true" : "false") << "}";
    is_first_ = false;
  }

  std::ostringstream json_;
  bool is_first_ = true;
};

}  // namespace unwrapd::bench
