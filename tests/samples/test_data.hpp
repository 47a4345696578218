#pragma once
// Where the real meshes are that tests read.

#include <filesystem>

namespace unwrapd {

/// The folder of real meshes: UNWRAPD_TEST_DATA, else ../shared/data beside the checkout; empty
/// where the checkout has none. Throws std::runtime_error where UNWRAPD_TEST_DATA names no folder:
/// tests would skip for a slip of the pen.
std::filesystem::path test_data();

}  // namespace unwrapd
