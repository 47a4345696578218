// The entry of libFuzzer, which mutates by coverage. --target=NAME chooses the target;
// --seeds=FOLDER writes its seeds there and ends the program.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/fuzz.hpp"

namespace unwrapd::fuzz {
namespace {

const Target* chosen = nullptr;

void write_seeds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const std::string& seed : chosen->seeds())
    std::ofstream(folder / ("seed_" + std::to_string(number++)), std::ios::binary) << seed;
}

}  // namespace
}  // namespace unwrapd::fuzz

/// Sanitizers: what asks for as much at once was not checked before. (Without them nothing calls
/// it.)
extern "C" const char* __asan_default_options() {  // NOLINT: the sanitizer gives the name
  return "max_allocation_size_mb=512";
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace unwrapd::fuzz;
  static const std::vector<Target> all = all_targets();
  std::string_view seeds;
  for (int i = 1; i < *argc; ++i) {
    const std::string_view word = (*argv)[i];
    if (word.starts_with("--seeds=")) seeds = word.substr(8);
    for (const Target& target : all)
      if (word == "--target=" + std::string(target.name)) chosen = &target;
  }
  if (chosen == nullptr) {
    std::fputs("--target= takes one of:", stderr);
    for (const Target& target : all) std::fprintf(stderr, " %s", std::string(target.name).c_str());
    std::fputc('\n', stderr);
    std::exit(2);
  }
  if (seeds.empty()) return 0;
  write_seeds(seeds);
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  unwrapd::fuzz::run_one(*unwrapd::fuzz::chosen, {reinterpret_cast<const char*>(data), size});
  return 0;
}
