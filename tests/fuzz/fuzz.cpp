#include "tests/fuzz/fuzz.hpp"

#include <cstdio>
#include <cstdlib>

#include "core/base/error.hpp"

namespace unwrapd::fuzz {

std::vector<Target> all_targets() {
  std::vector<Target> all;
  for (const auto& some : {asset_targets(), api_targets(), http_targets(), worker_targets()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

void promise(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

void run_one(const Target& target, std::string_view bytes) {
  try {
    target.run(bytes);
  } catch (const Error& error) {
    promise(error.code() != ErrorCode::internal, "bad bytes are no mistake of the server");
    promise(error.what()[0] != '\0', "an error says what is wrong");
  }
}

std::string grid_obj(int n) {
  std::string text = "vn 0 0 1\n";
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      text += "v " + std::to_string(x) + ' ' + std::to_string(y) + " 0." +
              std::to_string(x * y % 7) + "\nvt 0." + std::to_string(x % 10) + " 0." +
              std::to_string(y % 10) + '\n';
  const auto corner = [&](int x, int y) {
    const std::string number = std::to_string(y * (n + 1) + x + 1);
    return ' ' + number + '/' + number + "/1";
  };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      text += "f" + corner(x, y) + corner(x + 1, y) + corner(x + 1, y + 1) + '\n';
      text += "f" + corner(x, y) + corner(x + 1, y + 1) + corner(x, y + 1) + '\n';
    }
  return text;
}

}  // namespace unwrapd::fuzz
