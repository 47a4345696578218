#include "client/upload.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "client/failure.hpp"
#include "client/files.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

Piece text_piece(std::string text) {
  const std::size_t bytes = text.size();
  return {std::move(text), {}, bytes};
}

Piece file_piece(const fs::path& path) { return {{}, path, file_bytes(path)}; }

/// The boundary line, long enough that no mesh contains it by chance.
constexpr const char* kBoundary = "unwrapd-5f1c9e27a84b4d0e9b3a6d7c2e8f0a14";

/// Escapes quotes and line ends in the names of a part's header, as browsers do.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"') {
      text += "%22";
    } else if (c == '\r' || c == '\n') {
      text += c == '\r' ? "%0D" : "%0A";
    } else {
      text += c;
    }
  }
  return text + '"';
}

std::string part_head(const std::string& name, const std::string& filename,
                      const std::string& content_type) {
  std::string head = std::string("--") + kBoundary + "\r\n" +
                     "Content-Disposition: form-data; name=" + quoted(name);
  if (!filename.empty()) head += "; filename=" + quoted(filename);
  return head + "\r\nContent-Type: " + content_type + "\r\n\r\n";
}

}  // namespace

std::size_t Upload::bytes() const {
  return std::accumulate(pieces.begin(), pieces.end(), std::size_t{0},
                         [](std::size_t sum, const Piece& piece) { return sum + piece.bytes; });
}

std::string media_type(const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".glb") return "model/gltf-binary";
  if (extension == ".gltf") return "model/gltf+json";
  if (extension == ".obj" || extension == ".stl" || extension == ".ply" || extension == ".off")
    return "model/" + extension.substr(1);
  if (extension == ".zip") return "application/zip";
  return "application/octet-stream";
}

Upload raw_upload(const fs::path& document) {
  return {media_type(document), {file_piece(document)}};
}

Upload json_upload(std::string text) { return {"application/json", {text_piece(std::move(text))}}; }

Upload multipart_upload(const std::string& options, const fs::path& document,
                        const std::vector<FileBeside>& buffers) {
  Upload upload{std::string("multipart/form-data; boundary=") + kBoundary, {}};
  const auto add = [&](std::string text) { upload.pieces.push_back(text_piece(std::move(text))); };
  add(part_head("options", "", "application/json") + options + "\r\n");
  add(part_head("mesh", document.filename().string(), media_type(document)));
  upload.pieces.push_back(file_piece(document));
  for (const FileBeside& buffer : buffers) {
    add("\r\n" + part_head("buffer", buffer.uri, "application/octet-stream"));
    upload.pieces.push_back(file_piece(buffer.file));
  }
  add(std::string("\r\n--") + kBoundary + "--\r\n");
  return upload;
}

std::size_t UploadReader::read(char* buffer, std::size_t capacity) {
  while (piece_ < upload_.pieces.size() && offset_ == upload_.pieces[piece_].bytes) {
    ++piece_;
    offset_ = 0;
    file_ = {};
  }
  if (piece_ == upload_.pieces.size()) return 0;
  const Piece& piece = upload_.pieces[piece_];
  const std::size_t count = read_piece(piece, buffer, std::min(capacity, piece.bytes - offset_));
  offset_ += count;
  return count;
}

std::size_t UploadReader::read_piece(const Piece& piece, char* buffer, std::size_t capacity) {
  if (piece.file.empty()) {
    std::memcpy(buffer, piece.text.data() + offset_, capacity);
    return capacity;
  }
  if (!file_.is_open()) file_.open(piece.file, std::ios::binary);
  file_.read(buffer, static_cast<std::streamsize>(capacity));
  const auto count = static_cast<std::size_t>(file_.gcount());
  if (count == 0)
    throw Failure(ExitCode::file, piece.file.string() + " cannot be read to its end; try again.");
  return count;
}

}  // namespace unwrapd::client
