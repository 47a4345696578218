#pragma once
// The bytes of a job's mesh: written as they arrive, read again when they are needed.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/asset/asset.hpp"
#include "server/blob_store.hpp"
#include "server/files.hpp"
#include "server/http.hpp"
#include "server/identity.hpp"
#include "server/job_record.hpp"
#include "server/spooled_text.hpp"
#include "server/take_room.hpp"

namespace unwrapd::server {

/// What a request has brought; its files are in the upload's folder, synced.
struct Upload {
  JobInput input;
  std::unique_ptr<SpooledText> options;  ///< JSON text of the part `options`, where there is one
};

/// Where an upload goes.
struct UploadFolder {
  std::filesystem::path path;
  TakeRoom room = {};
};

/// The whole body is the document. Throws what BodyReader throws, and unknown_format when it is
/// empty.
Upload receive_asset(BodyReader& body, const UploadFolder& folder);

/// Parts: options (optional), mesh, and any number whose filename is a buffer's URI. Throws
/// malformed_request when a part is missing, given twice or without a filename.
Upload receive_parts(BodyReader& body, const UploadFolder& folder);

/// A job's input in memory, and its record with all its options, checked against their digests; the
/// views of input() live as long as this. Throws Error{storage_corrupt}.
class LoadedInput {
 public:
  LoadedInput(const BlobStore& blobs, const JobRecord& job);
  [[nodiscard]] asset::Input input() const;
  [[nodiscard]] const JobRecord& record() const { return record_; }

 private:
  JobRecord record_;
  std::string document_;
  std::vector<std::pair<std::string, std::string>> buffers_;  // URI, bytes
};

}  // namespace unwrapd::server
