#pragma once
// The files of jobs: DIR/blobs/<job>/{document,buffer_N,result.*,report.json*,layout.svg,uv.bin*}.
// An upload grows in DIR/incoming/<job>/ and is renamed as a whole; every later file is written
// under another name, synced and renamed. What a crash leaves behind is swept at the next start.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace unwrapd::server {

inline constexpr std::string_view kDocumentFile = "document";
inline constexpr std::string_view kReportFile = "report.json";
inline constexpr std::string_view kLayoutFile = "layout.svg";
inline constexpr std::string_view kTotalsFile = "totals.json";
inline constexpr std::string_view kUvFile = "uv.bin";

/// "result.glb", "result.gltf", "result.obj" or "result.json".
std::string result_file(std::string_view format);

class BlobStore {
 public:
  /// Creates the directories below data where they are missing.
  explicit BlobStore(const std::filesystem::path& data);

  /// A new empty folder for an upload.
  std::filesystem::path begin_upload(std::string_view job);
  /// The upload becomes the job's folder. Its files must be synced.
  void keep_upload(std::string_view job);
  void drop_upload(std::string_view job) noexcept;

  [[nodiscard]] std::filesystem::path path(std::string_view job, std::string_view file) const;
  void write(std::string_view job, std::string_view file, std::string_view bytes);
  void remove(std::string_view job) noexcept;

  /// Removes unfinished uploads and files, and the folders of jobs that is_known refuses.
  void sweep(const std::function<bool(const std::string& job)>& is_known);

 private:
  std::filesystem::path incoming_;
  std::filesystem::path blobs_;
};

}  // namespace unwrapd::server
