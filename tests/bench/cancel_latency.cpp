// How long a job goes without looking whether it was told to stop: every stretch of a whole job in
// processor time, so that no moment is left to chance, and where the long ones lie.
//   unwrapd_cancel_latency [--least MS] CASE...
//   CASE: noisy:FACES (closed, like a scan), disk:FACES, boxes:COUNT, or a file: read, unwrapped,
//   written as it came
// The program has its own core/base/cancel.cpp: the linker takes the functions below.
#include "core/base/cancel.hpp"

#include <cxxabi.h>
#include <execinfo.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "core/asset/asset.hpp"
#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/noisy_body.hpp"

namespace unwrapd {
namespace bench {
namespace {

double cpu_milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// The stretches between looks of one job.
class Looks {
 public:
  void begin(double least) {
    least_ = least;
    stretches_.clear();
    longest_ = 0;
    count_ = 0;
    from_ = nullptr;
    last_ = cpu_milliseconds();
  }

  void note(void* caller) {
    const double now = cpu_milliseconds();
    ++count_;
    longest_ = std::max(longest_, now - last_);
    if (now - last_ >= least_) keep(now - last_, caller);
    from_ = caller;
    last_ = cpu_milliseconds();
  }

  void print(const std::string& name, double seconds) const {
    std::printf("%-22s %8.1f s %9ld looks, longest stretch %6.0f ms\n", name.c_str(), seconds,
                count_, longest_);
    for (const auto& [ends, own] : stretches_)
      std::printf("  %6.0f ms, %4d times: %s -> %s (%s)\n", own.longest, own.times,
                  place(ends.first).c_str(), place(ends.second).c_str(), own.stack.c_str());
  }

 private:
  struct Stretch {
    double longest = 0;
    int times = 0;
    std::string stack = {};
  };

  void keep(double milliseconds, void* caller) {
    Stretch& own = stretches_[{from_, caller}];
    ++own.times;
    if (milliseconds <= own.longest) return;
    own.longest = milliseconds;
    own.stack.clear();
    std::array<void*, 12> frames{};
    const int depth = backtrace(frames.data(), static_cast<int>(frames.size()));
    for (int k = 3; k < depth && k < 9; ++k) own.stack += place(frames[k]) + " < ";
  }

  /// The function that an address lies in, by the symbol table.
  static std::string place(void* address) {
    if (address == nullptr) return "begin";
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), "addr2line -Cfse /proc/%d/exe %p", getpid(), address);
    FILE* pipe = popen(line.data(), "r");
    std::string text = fgets(line.data(), line.size(), pipe) != nullptr ? line.data() : "?";
    pclose(pipe);
    text = text.substr(0, text.find_first_of("(\n"));
    for (const std::string noise : {"unwrapd::", "(anonymous namespace)::"})
      for (auto at = text.find(noise); at != std::string::npos; at = text.find(noise))
        text.erase(at, noise.size());
    return text;
  }

  std::map<std::pair<void*, void*>, Stretch> stretches_;
  double least_ = 0, longest_ = 0, last_ = 0;
  long count_ = 0;
  void* from_ = nullptr;
};

Looks looks;
thread_local bool is_watched = false;

}  // namespace
}  // namespace bench

bool is_cancelled(const std::stop_token& stop) {
  if (bench::is_watched && stop.stop_possible()) bench::looks.note(__builtin_return_address(0));
  return stop.stop_requested();
}

void throw_if_cancelled(const std::stop_token& stop) {
  if (bench::is_watched && stop.stop_possible()) bench::looks.note(__builtin_return_address(0));
  if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "the job was cancelled");
}

namespace bench {
namespace {

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

double number_in(const std::string& name) {
  return std::strtod(name.c_str() + name.find(':') + 1, nullptr);
}

TriMesh boxes(double count) {
  std::vector<TriMesh> all;
  for (int k = 0; k < count; ++k)
    all.push_back(shapes::moved(shapes::cube(), {3.0 * (k % 100), 3.0 * (k / 100), 0.001 * k}));
  return shapes::merged(all);
}

TriMesh mesh_of(const std::string& name) {
  if (name.starts_with("noisy:")) return noisy_body(number_in(name), 0.25);
  if (name.starts_with("disk:")) return surface(number_in(name));
  return boxes(number_in(name));
}

/// The job whose looks are watched.
void run(const std::string& name, const std::string& bytes, std::span<const Surface> surfaces) {
  const std::stop_source source;  // never asked
  const Progress progress{{}, {}, source.get_token()};
  SerialExecutor serial;
  if (bytes.empty()) {
    unwrap(surfaces, {}, progress, serial);
    return;
  }
  asset::Input input;
  input.document = bytes;
  const asset::Asset asset = asset::read(input, {});
  const Unwrapped unwrapped = unwrap(asset.surfaces(), {}, progress, serial);
  throw_if_cancelled(progress.stop);
  const auto format = name.ends_with(".obj") ? asset::Format::obj : asset::Format::glb;
  const std::string written = asset::write(asset, unwrapped.surfaces, format);
  throw_if_cancelled(progress.stop);
}

void watch(const std::string& name, double least) {
  const bool is_made = name.find(':') != std::string::npos;
  const std::string bytes = is_made ? std::string() : read_file(name);
  std::vector<Surface> surfaces;
  if (is_made) surfaces.push_back(shapes::surface_of(mesh_of(name)));
  is_watched = true;
  looks.begin(least);
  const double begin = cpu_milliseconds();
  run(name, bytes, surfaces);
  is_watched = false;
  looks.print(name.substr(name.rfind('/') + 1), (cpu_milliseconds() - begin) / 1e3);
}

}  // namespace
}  // namespace bench
}  // namespace unwrapd

int main(int argc, char** argv) {
  double least = 50;
  for (int k = 1; k < argc; ++k) {
    const std::string name = argv[k];
    if (name == "--least" && k + 1 < argc)
      least = std::strtod(argv[++k], nullptr);
    else
      unwrapd::bench::watch(name, least);
    std::fflush(stdout);
  }
}
