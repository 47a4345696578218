#pragma once
// Charts as bytes, for processes that work on one job together (shared_work.hpp).

#include "core/base/byte_pack.hpp"
#include "core/charts/charts.hpp"

namespace unwrapd::charts {

void pack(BytePacker& bytes, const Chart& chart);

/// Reads charts that are parts of one that is known, from bytes that came from outside: each index
/// is in range, each number finite, and every list as long as it must be. Throws Error{internal}.
class PartReader {
 public:
  /// whole: must outlive this.
  explicit PartReader(const Chart& whole);

  Chart next(ByteUnpacker& bytes);
  /// Throws unless the charts read so far have each face of the whole one once.
  void require_all() const;

 private:
  std::vector<Index> sources_;  ///< the whole chart's faces of the surface, ascending
  std::size_t left_;            ///< faces that no part has had
  std::vector<char> is_used_;   ///< one for each of sources_
};

/// One map for so many vertices, all of its numbers finite. Throws Error{internal}.
UvMap next_map(ByteUnpacker& bytes, std::size_t vertices);

}  // namespace unwrapd::charts
