#pragma once
// A text that arrives slowly and may be long: in memory while it is short, then in a file, so that
// many long uploads at once take no memory.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/files.hpp"
#include "server/store/upload_meter.hpp"

namespace unwrapd::server::uploads {

class SpooledText {
 public:
  /// file: created when it is needed, removed with this.
  explicit SpooledText(std::filesystem::path file, store::UploadMeter room = {})
      : path_(std::move(file)), room_(std::move(room)) {}
  SpooledText(const SpooledText&) = delete;
  SpooledText& operator=(const SpooledText&) = delete;
  ~SpooledText();

  /// Throws what UploadMeter throws, and storage_failed.
  void append(std::string_view bytes);
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool is_long() const { return file_.has_value(); }
  /// The whole text. Throws Error{storage_failed}.
  [[nodiscard]] std::string read();

 private:
  void spill();

  const std::filesystem::path path_;
  const store::UploadMeter room_;
  std::string unwritten_;
  std::size_t size_ = 0;
  std::int64_t taken_ = 0;  // of room
  std::optional<File> file_;
};

}  // namespace unwrapd::server::uploads
