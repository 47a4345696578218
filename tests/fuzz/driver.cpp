// A driver for compilers without libFuzzer: seeded mutations of the seeds, as many as asked for.
// Seeds are the files of the folders given, and a few small ones made here.
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr std::size_t kMaxSeedBytes = 200'000;

std::vector<std::string> made_seeds() {
  return {"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nf -1 -2 -3\n",
          R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0},)"
          R"("indices":1}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,)"
          R"("type":"VEC3"},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],)"
          R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,)"
          R"("byteLength":6}],"buffers":[{"byteLength":42,"uri":"data:;base64,)"
          R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]})"};
}

void add_seeds(const std::filesystem::path& folder, std::vector<std::string>& seeds) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.file_size() > kMaxSeedBytes) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
}

std::string mutated(std::string bytes, const std::vector<std::string>& seeds,
                    std::mt19937_64& random) {
  constexpr char kLikely[] = "0123456789-{}[],:\"e./ \n";
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
        bytes.insert(at, other.substr(other.empty() ? 0 : random() % other.size(), random() % 64));
        break;
      default:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    }
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t runs = 100'000;
  std::vector<std::string> seeds = made_seeds();
  for (int i = 1; i < argc; ++i) {
    if (std::strncmp(argv[i], "-runs=", 6) == 0)
      runs = std::strtoull(argv[i] + 6, nullptr, 10);
    else
      add_seeds(argv[i], seeds);
  }
  std::mt19937_64 random(1);
  for (std::uint64_t run = 0; run < runs; ++run) {
    const std::string bytes = mutated(seeds[random() % seeds.size()], seeds, random);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  std::printf("%llu runs over %zu seeds\n", static_cast<unsigned long long>(runs), seeds.size());
  return 0;
}
