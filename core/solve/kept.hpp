#pragma once
// What is made of a disk once for all jobs that have that disk.

#include <memory>
#include <vector>

#include "core/linear/engine.hpp"
#include "core/solve/disk.hpp"

namespace unwrapd {

template <typename T>
std::size_t bytes_of(const std::vector<T>& list) {
  return sizeof(T) * list.size();
}
template <typename T>
std::size_t bytes_of(const SharedList<T>& list) {
  return sizeof(T) * list.size();
}
inline std::size_t bytes_of(const Halfedges& halfedges) { return bytes_of(halfedges.twin); }
inline std::size_t bytes_of(const Analysis& analysis) { return analysis.bytes(); }
inline std::size_t bytes_of(const Factor& factor) { return factor.bytes(); }

/// What make() gives, a std::shared_ptr<const T>, or an equal one that another job made. content:
/// all that it is made from. core: null where nothing is shared. Throws Error{cancelled}.
template <typename Make>
auto kept(SolverCore* core, const Content& content, Make make, const std::stop_token& stop) {
  using Value = typename decltype(make())::element_type;
  if (core == nullptr) return std::shared_ptr<const Value>(make());
  return std::static_pointer_cast<const Value>(core->obtain(
      core->digest(content),
      [&]() -> SolverCore::Made {
        const std::shared_ptr<const Value> value = make();
        return {value, bytes_of(*value)};
      },
      stop));
}

/// The same of a disk: content says disk.connectivity or disk.content, and what else counts.
template <typename Make>
auto kept(const Disk& disk, const Content& content, Make make) {
  return kept(disk.core, content, make, disk.stop);
}

/// As kept(), of a value that make() returns, copied.
template <typename Make>
auto kept_value(const Disk& disk, const Content& content, Make make) {
  using Value = decltype(make());
  if (disk.core == nullptr) return make();
  return Value(*kept(disk, content, [&] { return std::make_shared<const Value>(make()); }));
}

/// Throws Error{too_much_memory} when a job on this disk that keeps so many bytes needs more than
/// it may have.
void check_memory(const Disk& disk, std::size_t bytes);

}  // namespace unwrapd
