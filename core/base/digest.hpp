#pragma once
// A short name of bytes: what has the same digest is the same.

#include <array>
#include <cstddef>

namespace unwrapd {

/// Stands for the bytes that it was made from.
using Digest = std::array<std::byte, 32>;

}  // namespace unwrapd
