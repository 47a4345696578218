#pragma once
// Runs independent searches on all threads of an executor.

#include <cstddef>
#include <exception>
#include <vector>

#include "core/base/executor.hpp"

namespace unwrapd::solve {

/// Returns search(0) .. search(count - 1), computed on any threads. Result is
/// default-constructible. If searches throw, throws what the first of them threw.
template <class Result, class Search>
std::vector<Result> parallel_map(std::size_t count, Executor& executor, const Search& search) {
  std::vector<Result> found(count);
  std::vector<std::exception_ptr> failure(count);
  executor.for_each_block(static_cast<int>(count), [&](int block) {
    const auto k = static_cast<std::size_t>(block);
    try {
      found[k] = search(k);
    } catch (...) {
      failure[k] = std::current_exception();
    }
  });
  for (const std::exception_ptr& own : failure)
    if (own) std::rethrow_exception(own);
  return found;
}

}  // namespace unwrapd::solve
