#include "core/segment/base/ranks.hpp"

#include <algorithm>
#include <utility>

namespace unwrapd::segment {
namespace {

/// Lists that no Ranks of this thread uses, all kNoTwin.
std::vector<std::vector<Index>>& idle() {
  thread_local std::vector<std::vector<Index>> lists;
  return lists;
}

}  // namespace

Ranks::Ranks(std::size_t face_count, std::span<const Index> faces) : faces_(faces) {
  if (!idle().empty()) {
    rank_ = std::move(idle().back());
    idle().pop_back();
  }
  if (rank_.size() < face_count) rank_.resize(face_count, kNoTwin);
  for (std::size_t k = 0; k < faces.size(); ++k)
    rank_[static_cast<std::size_t>(faces[k])] = static_cast<Index>(k);
}

Ranks::~Ranks() {
  for (const Index t : faces_) rank_[static_cast<std::size_t>(t)] = kNoTwin;
  idle().push_back(std::move(rank_));
}

}  // namespace unwrapd::segment
