// A driver for compilers without libFuzzer, and for the short run of every test run: all targets,
// so many seeded mutations of their seeds each. It knows no coverage: what it can find is shallow.
#include <cstdio>
#include <cstdlib>
#include <random>

#include "tests/fuzz/fuzz.hpp"

namespace unwrapd::fuzz {
namespace {

std::string mutated(std::string bytes, const std::vector<std::string>& seeds,
                    std::mt19937_64& random) {
  constexpr char kLikely[] = "0123456789-{}[],:\"e./ \r\n";
  for (std::uint64_t k = random() % 6; k > 0 && !bytes.empty(); --k) {
    const std::size_t at = random() % bytes.size();
    const std::string& other = seeds[random() % seeds.size()];
    switch (random() % 6) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = kLikely[random() % (sizeof kLikely - 1)];
        break;
      case 2:
        bytes.erase(at, 1 + random() % 16);
        break;
      case 3:
        bytes.insert(at, bytes.substr(random() % bytes.size(), 1 + random() % 16));
        break;
      case 4:
        bytes.insert(at, other.substr(random() % other.size(), random() % 64));
        break;
      default:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    }
  }
  return bytes;
}

void run_target(const Target& target, std::uint64_t runs) {
  const std::vector<std::string> seeds = target.seeds();
  std::mt19937_64 random(1);
  for (const std::string& seed : seeds) run_one(target, seed);
  for (std::uint64_t run = 0; run < runs; ++run)
    run_one(target, mutated(seeds[random() % seeds.size()], seeds, random));
  std::printf("%s: %llu runs over %zu seeds\n", std::string(target.name).c_str(),
              static_cast<unsigned long long>(runs), seeds.size());
}

}  // namespace
}  // namespace unwrapd::fuzz

/// fuzz [RUNS]
int main(int argc, char** argv) {
  const std::uint64_t runs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000;
  for (const unwrapd::fuzz::Target& target : unwrapd::fuzz::all_targets())
    unwrapd::fuzz::run_target(target, runs);
  return 0;
}
