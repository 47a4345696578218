#include "server/job_input.hpp"

#include <algorithm>

#include "api/options.hpp"
#include "core/error.hpp"

namespace unwrapd::server {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{256} * 1024;
constexpr std::size_t kMaxBuffers = 1000;

/// A file that grows in pieces worth a system call each.
class GrowingFile {
 public:
  explicit GrowingFile(const std::filesystem::path& path) : file_(File::create(path)) {}

  void append(std::string_view bytes) {
    pending_.append(bytes);
    if (pending_.size() >= kPieceBytes) flush();
  }
  void finish() {
    flush();
    file_.sync();
  }

 private:
  void flush() {
    file_.append(pending_);
    pending_.clear();
  }

  File file_;
  std::string pending_;
};

[[noreturn]] void malformed(const std::string& what) {
  throw Error(ErrorCode::malformed_request, what);
}

/// The parts of a form, each to its place.
class PartWriter {
 public:
  explicit PartWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void start(const Part& part) {
    finish_file();
    in_options_ = part.name == "options";
    in_document_ = part.name == "mesh";
    if (in_options_) {
      start_options();
    } else if (in_document_) {
      start_document();
    } else {
      start_buffer(part);
    }
  }

  void append(std::string_view bytes) {
    if (in_options_) return append_option_text(bytes);
    if (in_document_) hash_.add(bytes);
    upload_.input.bytes += static_cast<std::int64_t>(bytes.size());
    file_->append(bytes);
  }

  Upload finish() {
    finish_file();
    if (!has_document_) malformed("There is no part named \"mesh\"; send the asset in it.");
    upload_.input.sha256 = hash_.finish();
    return std::move(upload_);
  }

 private:
  void start_options() {
    if (upload_.options) malformed("There are two parts named \"options\"; send one.");
    upload_.options.emplace();
  }

  void append_option_text(std::string_view bytes) {
    upload_.options->append(bytes);
    if (upload_.options->size() > api::kMaxOptionsBytes)
      throw Error(ErrorCode::body_too_large, "The part \"options\" exceeds 16 MiB; shorten it.");
  }

  void start_document() {
    if (has_document_) malformed("There are two parts named \"mesh\"; send one.");
    has_document_ = true;
    file_.emplace(folder_ / kDocumentFile);
  }

  void start_buffer(const Part& part) {
    std::vector<StoredBuffer>& buffers = upload_.input.buffers;
    if (part.filename.empty())
      malformed("A part has no filename; a buffer's is the URI by which the asset names it.");
    if (std::ranges::find(buffers, part.filename, &StoredBuffer::uri) != buffers.end())
      malformed("Two parts have the same filename; send every buffer once.");
    if (buffers.size() == kMaxBuffers) malformed("There are over 1000 buffers; send fewer.");
    buffers.push_back({part.filename, "buffer_" + std::to_string(buffers.size())});
    file_.emplace(folder_ / buffers.back().file);
  }

  void finish_file() {
    if (file_) file_->finish();
    file_.reset();
  }

  const std::filesystem::path folder_;
  Upload upload_;
  Sha256 hash_;
  std::optional<GrowingFile> file_;
  bool in_options_ = false;
  bool in_document_ = false;
  bool has_document_ = false;
};

}  // namespace

Upload receive_asset(BodyReader& body, const std::filesystem::path& folder) {
  Upload upload;
  Sha256 hash;
  GrowingFile file(folder / kDocumentFile);
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

Upload receive_parts(BodyReader& body, const std::filesystem::path& folder) {
  PartWriter writer(folder);
  body.read_parts([&](const Part& part) { writer.start(part); },
                  [&](std::string_view bytes) { writer.append(bytes); });
  return writer.finish();
}

LoadedInput::LoadedInput(const BlobStore& blobs, const JobRecord& job)
    : document_(read_file(blobs.path(job.id, kDocumentFile))) {
  buffers_.reserve(job.input.buffers.size());
  for (const StoredBuffer& buffer : job.input.buffers)
    buffers_.emplace_back(buffer.uri, read_file(blobs.path(job.id, buffer.file)));
}

asset::Input LoadedInput::input() const {
  asset::Input input{.document = document_, .buffers = {}};
  for (const auto& [uri, bytes] : buffers_) input.buffers[uri] = bytes;
  return input;
}

}  // namespace unwrapd::server
