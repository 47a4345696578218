// Tests of real meshes skip where there are none. So that they never skip beside the data, the
// folder is looked for here by another way: from the program upwards.
#include "tests/samples/test_data.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace unwrapd {
namespace {

namespace fs = std::filesystem;

/// The checkout that holds the build folder of this program, empty if it is elsewhere.
fs::path checkout_above() {
  for (fs::path at = fs::read_symlink("/proc/self/exe"); at.has_relative_path();
       at = at.parent_path())
    if (fs::exists(at / "tests/samples/test_data.cpp")) return at;
  return {};
}

/// Sets a variable of the environment for as long as it lives.
class Variable {
 public:
  explicit Variable(const char* value) {
    if (const char* now = std::getenv(kName)) before_ = now, was_set_ = true;
    if (value != nullptr)
      ::setenv(kName, value, 1);
    else
      ::unsetenv(kName);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  ~Variable() {
    if (was_set_)
      ::setenv(kName, before_.c_str(), 1);
    else
      ::unsetenv(kName);
  }

 private:
  static constexpr const char* kName = "UNWRAPD_TEST_DATA";
  std::string before_;
  bool was_set_ = false;
};

TEST(TestData, IsFoundBesideTheCheckoutFromAnyFolder) {
  const fs::path beside = checkout_above() / "../shared/data";
  if (checkout_above().empty() || !fs::is_directory(beside))
    GTEST_SKIP() << "this checkout has no ../shared/data";
  const Variable none(nullptr);
  const fs::path before = fs::current_path();
  fs::current_path("/");
  EXPECT_EQ(test_data(), fs::canonical(beside));
  fs::current_path(before);
}

TEST(TestData, IsNotSkippedForAFolderThatIsNamedWrongly) {
  const Variable wrong("/nowhere/at/all");
  EXPECT_THROW(test_data(), std::runtime_error);
}

}  // namespace
}  // namespace unwrapd
