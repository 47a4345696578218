#pragma once
// Two real threads, to see that results do not depend on how many there are.

#include <thread>

#include "core/base/executor.hpp"

namespace unwrapd {

/// Odd blocks on a second thread, even blocks here.
class TwoThreads final : public Executor {
 public:
  void for_each_block(int block_count, const std::function<void(int)>& body) override {
    std::thread other([&] {
      for (int block = 1; block < block_count; block += 2) body(block);
    });
    for (int block = 0; block < block_count; block += 2) body(block);
    other.join();
  }
};

}  // namespace unwrapd
