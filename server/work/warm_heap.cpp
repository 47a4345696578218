#include "server/work/warm_heap.hpp"

#include <poll.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <vector>

namespace unwrapd::server::work {
namespace {

constexpr std::size_t kPiece = std::size_t{2} << 20;  // a huge page
constexpr std::size_t kPage = 4096;
constexpr std::int64_t kProgram = std::int64_t{12} << 20;  // of a process that has done nothing
constexpr std::int64_t kMostWarm = std::int64_t{40} << 20;

bool is_readable(int descriptor) {
  pollfd polled{descriptor, POLLIN, 0};
  return ::poll(&polled, 1, 0) != 0;
}

}  // namespace

void warm_heap(std::int64_t bytes, int until_readable) {
  using Piece = std::unique_ptr<volatile char[]>;
  std::vector<Piece> taken;
  for (std::int64_t left = bytes; left > 0 && !is_readable(until_readable); left -= kPiece) {
    Piece piece(new (std::nothrow) volatile char[kPiece]);
    if (!piece) break;
    for (std::size_t at = 0; at < kPiece; at += kPage) piece[at] = 0;
    taken.push_back(std::move(piece));
  }
}

std::int64_t heap_of_largest_child() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  return std::clamp<std::int64_t>(used.ru_maxrss * 1024 - kProgram, 0, kMostWarm);
}

}  // namespace unwrapd::server::work
