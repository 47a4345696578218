#pragma once
// Memoizes functions across jobs: a result is stored under a key made of the function's arguments.

#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "core/linear/engine.hpp"
#include "core/solve/base/disk.hpp"
#include "core/types/cache_key.hpp"

namespace unwrapd::solve {

template <typename T>
std::size_t bytes_of(const std::vector<T>& list) {
  return sizeof(T) * list.size();
}
template <typename T>
std::size_t bytes_of(const SharedList<T>& list) {
  return sizeof(T) * list.size();
}
inline std::size_t bytes_of(const Halfedges& halfedges) { return bytes_of(halfedges.twin); }
inline std::size_t bytes_of(const linear::Analysis& analysis) { return analysis.bytes(); }
inline std::size_t bytes_of(const linear::Factor& factor) { return factor.bytes(); }

/// How to make a value. No member, of this type or of a derived one, may change the value.
struct CacheContext {
  SharedCache* core = nullptr;  ///< null: nothing is shared
  std::stop_token stop = {};
  Executor* executor = nullptr;  ///< null: the calling thread
};

/// The address of this object identifies the function in its keys.
template <auto kMake>
inline constexpr char kKind = 0;

template <auto kMake, class... Inputs>
Digest key_of(const SharedCache& core, const Inputs&... inputs) {
  CacheKey key(core);
  key.add(reinterpret_cast<std::uintptr_t>(&kKind<kMake>));
  (key.add(inputs), ...);
  return key.digest();
}

template <typename T>
std::shared_ptr<const T> shared(std::shared_ptr<const T> made) {
  return made;
}
template <typename T>
std::shared_ptr<const T> shared(T made) {
  return std::make_shared<const T>(std::move(made));
}

/// Returns kMake(by, inputs...), or an equal value that another job made. The result is a
/// std::shared_ptr<const T>, whether kMake returns one or a T. kMake is a function, or a lambda
/// without captures: the key contains all that it can read except `by`, which is a CacheContext or
/// derived from it. Throws Error{cancelled}, and what kMake throws.
template <auto kMake, class By, class... Inputs>
auto cached(const By& by, Inputs&&... inputs) {
  static_assert(std::is_base_of_v<CacheContext, By>);
  using Pointer = decltype(shared(kMake(by, inputs...)));
  if (by.core == nullptr) return shared(kMake(by, inputs...));
  const auto make = [&]() -> SharedCache::Made {
    const Pointer value = shared(kMake(by, inputs...));
    return {value, bytes_of(*value)};
  };
  return std::static_pointer_cast<typename Pointer::element_type>(
      by.core->obtain(key_of<kMake>(*by.core, inputs...), make, by.stop));
}

/// A copy of kMake(disk, inputs...), memoized. The present state of the disk is part of the key.
template <auto kMake, class... Inputs>
auto cached_of_disk(const Disk& disk, const Inputs&... inputs) {
  constexpr auto kOfDisk = [](const CacheContext&, const auto&... all) { return kMake(all...); };
  if (disk.core == nullptr) return kMake(disk, inputs...);
  return decltype(kMake(disk, inputs...))(
      *cached<kOfDisk>(CacheContext{disk.core, disk.stop}, disk, inputs...));
}

/// Throws Error{too_much_memory} if a job on this disk that allocates `bytes` exceeds its limit.
void check_memory(const Disk& disk, std::size_t bytes);

}  // namespace unwrapd::solve
