#pragma once
// The pictures of a job: drawn when somebody asks, from what the job keeps anyway.

#include <mutex>
#include <string>

#include "api/limits.hpp"
#include "core/figure/colour_scale.hpp"
#include "server/blob_store.hpp"
#include "server/job_record.hpp"
#include "server/result_store.hpp"

namespace unwrapd::server {

enum class PictureKind { layout_svg, layout_png, preview_png };

struct Picture {
  PictureKind kind = PictureKind::layout_svg;
  Colouring colouring = Colouring::stretch;    ///< of layouts
  int size = kDefaultImageSize;                ///< of PNGs, pixels
  std::string uv_file = std::string(kUvFile);  ///< the map to draw: a file of the job
};

/// Thread-safe.
class PictureStore {
 public:
  PictureStore(BlobStore& blobs, const api::Limits& limits) : blobs_(blobs), limits_(limits) {}

  /// The picture of a succeeded job. Those whose size is a power of two are kept with the job, so
  /// that whoever asks for every size fills no disk.
  StoredResult open(const JobRecord& job, const Picture& picture);
  [[nodiscard]] const FileCounts& counts() const { return counts_; }

 private:
  std::string draw(const JobRecord& job, const Picture& picture) const;
  void draw_into_store(const JobRecord& job, const Picture& picture, const std::string& name);

  BlobStore& blobs_;
  const api::Limits& limits_;
  FileCounts counts_;
  std::mutex drawing_;  // one at a time, as for results in other formats
};

}  // namespace unwrapd::server
