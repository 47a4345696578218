#include "server/uploads/job_input.hpp"

#include <algorithm>
#include <optional>

#include "api/options.hpp"
#include "core/base/error.hpp"
#include "server/base/files.hpp"
#include "server/base/identity.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/uploads/job_name.hpp"

namespace unwrapd::server::uploads {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{256} * 1024;
constexpr std::size_t kMaxBuffers = 1000;
constexpr std::size_t kMaxFieldBytes = std::size_t{64} * 1024;  // of a form, with their names
constexpr std::string_view kSentOptionsFile = "options.sent";   // until they are read

/// A file that is written in large pieces.
class GrowingFile {
 public:
  GrowingFile(const std::filesystem::path& path, const store::UploadMeter& room)
      : file_(File::create(path)), room_(room) {}

  void append(std::string_view bytes) {
    pending_.append(bytes);
    if (pending_.size() >= kPieceBytes) flush();
  }
  /// BlobStore::keep_upload() syncs it.
  void finish() {
    flush();
    file_.begin_sync();
  }

 private:
  void flush() {
    room_.take(static_cast<std::int64_t>(pending_.size()));
    file_.append(pending_);
    pending_.clear();
  }

  File file_;
  const store::UploadMeter& room_;
  std::string pending_;
};

[[noreturn]] void malformed(const std::string& what) {
  throw Error(ErrorCode::malformed_request, what);
}

/// Writes the parts of a form, each to its file.
class PartWriter {
 public:
  explicit PartWriter(const store::UploadFolder& folder) : folder_(folder) {}

  void start(const http::Part& part) {
    finish_file();
    in_options_ = part.name == "options";
    in_document_ = part.name == "mesh" || part.name == "file";
    field_ = nullptr;
    if (in_options_) {
      start_options();
    } else if (in_document_) {
      start_document();
    } else if (part.name == "buffer") {
      start_buffer(part);
    } else if (part.filename.empty() && !part.name.empty()) {
      start_field(part.name);
    } else {
      malformed(
          "A part has no name, or a file is not named \"mesh\", \"file\" or \"buffer\"; use one of "
          "these names.");
    }
  }

  void append(std::string_view bytes) {
    if (in_options_) return append_option_text(bytes);
    if (field_ != nullptr) return append_field_text(bytes);
    hash_->add(bytes);
    upload_.input.bytes += static_cast<std::int64_t>(bytes.size());
    file_->append(bytes);
  }

  Upload finish() {
    finish_file();
    if (!has_document_)
      malformed("The form has no part named \"mesh\" or \"file\"; send the asset in it.");
    if (upload_.options && upload_.fields.size() > upload_.fields.count(kNameParameter))
      malformed(
          "The form has options in the part \"options\" and in parts of their own; use one way.");
    return std::move(upload_);
  }

 private:
  void start_options() {
    if (upload_.options) malformed("The form has two parts named \"options\"; send one.");
    upload_.options = std::make_unique<SpooledText>(folder_.path / kSentOptionsFile, folder_.room);
  }

  void append_option_text(std::string_view bytes) {
    if (upload_.options->size() + bytes.size() > api::kMaxOptionsBytes)
      throw Error(ErrorCode::body_too_large, "The part \"options\" exceeds 16 MiB; shorten it.");
    upload_.options->append(bytes);
  }

  void start_field(const std::string& name) {
    take_field_bytes(name.size());
    field_ = &upload_.fields.emplace(name, "")->second;
  }

  void append_field_text(std::string_view bytes) {
    take_field_bytes(bytes.size());
    field_->append(bytes);
  }

  void take_field_bytes(std::size_t bytes) {
    field_bytes_ += bytes;
    if (field_bytes_ > kMaxFieldBytes)
      throw Error(ErrorCode::body_too_large,
                  "Options in parts of their own exceed 64 KiB; send them as JSON in the part "
                  "\"options\".");
  }

  void start_document() {
    if (has_document_) malformed("The form has two meshes; send one.");
    has_document_ = true;
    open(blobs::kDocumentFile, upload_.input.sha256);
  }

  void start_buffer(const http::Part& part) {
    std::vector<store::StoredBuffer>& buffers = upload_.input.buffers;
    if (part.filename.empty())
      malformed(
          "A part with a buffer has no filename; send the URI by which the asset names the "
          "buffer.");
    if (std::ranges::find(buffers, part.filename, &store::StoredBuffer::uri) != buffers.end())
      malformed("Two parts have the same filename; send every buffer once.");
    if (buffers.size() == kMaxBuffers) malformed("The form has over 1000 buffers; send fewer.");
    buffers.push_back(
        {.uri = part.filename, .file = blobs::buffer_file(buffers.size()), .sha256 = {}});
    open(buffers.back().file, buffers.back().sha256);
  }

  /// The next bytes go to this file; its digest will be put there.
  void open(std::string_view file, std::string& digest) {
    file_.emplace(folder_.path / file, folder_.room);
    hash_.emplace();
    digest_ = &digest;
  }

  void finish_file() {
    if (!file_) return;
    file_->finish();
    file_.reset();
    *digest_ = hash_->finish();
  }

  const store::UploadFolder& folder_;
  Upload upload_;
  std::optional<Sha256> hash_;
  std::string* digest_ = nullptr;  // of the open file
  std::optional<GrowingFile> file_;
  std::string* field_ = nullptr;  // of the present part, if it is an option
  std::size_t field_bytes_ = 0;
  bool in_options_ = false;
  bool in_document_ = false;
  bool has_document_ = false;
};

}  // namespace

Upload receive_asset(http::BodyReader& body, const store::UploadFolder& folder) {
  Upload upload;
  Sha256 hash;
  GrowingFile file(folder.path / blobs::kDocumentFile, folder.room);
  body.read([&](std::string_view bytes) {
    hash.add(bytes);
    upload.input.bytes += static_cast<std::int64_t>(bytes.size());
    file.append(bytes);
  });
  if (upload.input.bytes == 0)
    throw Error(ErrorCode::unknown_format, "The body is empty; send a GLB, glTF or OBJ file.");
  file.finish();
  upload.input.sha256 = hash.finish();
  return upload;
}

Upload receive_parts(http::BodyReader& body, const store::UploadFolder& folder) {
  PartWriter writer(folder);
  body.read_parts([&](const http::Part& part) { writer.start(part); },
                  [&](std::string_view bytes) { writer.append(bytes); });
  return writer.finish();
}

}  // namespace unwrapd::server::uploads
