#include "tests/samples/test_data.hpp"

#include <cstdlib>
#include <stdexcept>

namespace unwrapd {

std::filesystem::path test_data() {
  const char* given = std::getenv("UNWRAPD_TEST_DATA");
  const std::filesystem::path path = given != nullptr ? given : UNWRAPD_DEFAULT_TEST_DATA;
  if (std::filesystem::is_directory(path)) return std::filesystem::canonical(path);
  if (given != nullptr)
    throw std::runtime_error("UNWRAPD_TEST_DATA names no folder: " + path.string());
  return {};
}

}  // namespace unwrapd
