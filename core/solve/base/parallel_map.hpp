#pragma once
// Searches that know nothing of each other, on as many threads as there are.

#include <cstddef>
#include <exception>
#include <vector>

#include "core/base/executor.hpp"

namespace unwrapd::solve {

/// What search(0) .. search(count - 1) return, on any threads; Result has a default. Throws what
/// the first of them that throws does.
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
