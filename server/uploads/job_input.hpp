#pragma once
// The bytes of a job's mesh, written as they arrive.

#include <memory>

#include "api/options.hpp"
#include "server/http/http.hpp"
#include "server/store/job_record.hpp"
#include "server/store/upload_meter.hpp"
#include "server/uploads/spooled_text.hpp"

namespace unwrapd::server::uploads {

/// What a request has brought; its files are in the upload's folder, synced.
struct Upload {
  store::JobInput input;
  std::unique_ptr<SpooledText> options;  ///< JSON text of the part `options`, where there is one
  api::Query fields;                     ///< the name and options in parts of their own, unchecked
};

/// The whole body is the document. Throws what BodyReader throws, and unknown_format when it is
/// empty.
Upload receive_asset(http::BodyReader& body, const store::UploadFolder& folder);

/// Parts: mesh, which may be called file; any number of parts buffer, whose filename is its URI;
/// and options as JSON, or each option in a part of its name, as text like that of a query; `name`
/// is such a part beside either. Throws malformed_request when a part is missing, given twice or
/// without a filename, and body_too_large.
Upload receive_parts(http::BodyReader& body, const store::UploadFolder& folder);

}  // namespace unwrapd::server::uploads
