#pragma once
// The body of a request as a list of pieces: text, and files that are read while they are sent.

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "client/files_beside.hpp"

namespace unwrapd::client {

/// Either text, or the bytes of a file.
struct Piece {
  std::string text;
  std::filesystem::path file;  ///< empty if the piece is text
  std::size_t bytes = 0;
};

struct Upload {
  std::string content_type;
  std::vector<Piece> pieces;

  [[nodiscard]] std::size_t bytes() const;
};

/// The document alone, with the media type of its extension.
Upload raw_upload(const std::filesystem::path& document);

/// multipart/form-data with the parts options (JSON), mesh and one a buffer, named by its URI.
Upload multipart_upload(const std::string& options, const std::filesystem::path& document,
                        const std::vector<FileBeside>& buffers);

/// JSON text.
Upload json_upload(std::string text);

/// "model/gltf-binary", "model/gltf+json", "model/" and the name of another format that is read;
/// else "application/octet-stream".
std::string media_type(const std::filesystem::path& path);

/// Reads an upload in order, a block at a time.
class UploadReader {
 public:
  explicit UploadReader(const Upload& upload) : upload_(upload) {}

  /// Fills buffer with the next bytes and returns their number; 0 at the end. Throws Failure{file}
  /// if a file has become shorter since its size was taken.
  std::size_t read(char* buffer, std::size_t capacity);

 private:
  std::size_t read_piece(const Piece& piece, char* buffer, std::size_t capacity);

  const Upload& upload_;
  std::size_t piece_ = 0;
  std::size_t offset_ = 0;  ///< within the piece
  std::ifstream file_;
};

}  // namespace unwrapd::client
