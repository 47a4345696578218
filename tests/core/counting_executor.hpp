#pragma once
// An executor that counts: work without a clock.

#include "core/base/executor.hpp"

namespace unwrapd {

/// Counts sweeps over the mesh, of which every iteration makes the same few.
class CountingExecutor final : public Executor {
 public:
  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    ++sweeps;
    for (int block = 0; block < block_count; ++block) body(block);
  }
  int sweeps = 0;
};

}  // namespace unwrapd
