#pragma once
// The bytes of a job's mesh, written as they arrive.

#include <memory>

#include "server/http/http.hpp"
#include "server/store/job_record.hpp"
#include "server/store/upload_meter.hpp"
#include "server/uploads/spooled_text.hpp"

namespace unwrapd::server::uploads {

/// What a request has brought; its files are in the upload's folder, synced.
struct Upload {
  store::JobInput input;
  std::unique_ptr<SpooledText> options;  ///< JSON text of the part `options`, where there is one
};

/// The whole body is the document. Throws what BodyReader throws, and unknown_format when it is
/// empty.
Upload receive_asset(http::BodyReader& body, const store::UploadFolder& folder);

/// Parts: options (optional), mesh, and any number whose filename is a buffer's URI. Throws
/// malformed_request when a part is missing, given twice or without a filename.
Upload receive_parts(http::BodyReader& body, const store::UploadFolder& folder);

}  // namespace unwrapd::server::uploads
