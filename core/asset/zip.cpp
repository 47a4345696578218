// libzip reads the archive from memory. The sizes in its directory are added up before anything is
// inflated, and no file inflates to more than its size there.
#include "core/asset/zip.hpp"

#include <zip.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <vector>

#include "core/asset/gltf/uris.hpp"
#include "core/asset/other_formats.hpp"
#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/base/lower_case.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::size_t kMaxEntries = 1000;         // as many as a form may have buffers
constexpr std::size_t kInflatedAtOnce = 1 << 16;  // bytes
constexpr std::array<std::string_view, 6> kEndings = {".glb", ".gltf", ".obj",
                                                      ".stl", ".ply",  ".off"};

[[noreturn]] void refuse_zip(const std::string& message) {
  throw Error(ErrorCode::malformed_mesh, message + "; pack the archive again");
}

/// The name for a message.
std::string quoted_name(std::string_view name) {
  constexpr std::size_t kMostName = 80;  // bytes
  return "\"" + std::string(name.substr(0, kMostName)) + "\"";
}

struct ZipEntry {
  zip_uint64_t number = 0;
  std::string name;
  std::size_t bytes = 0;  ///< inflated
};

std::string_view ending_of(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : name.substr(dot);
}

std::string ending_in_lower_case(const std::string& name) { return lower_case(ending_of(name)); }

bool is_asset_name(const std::string& name) {
  return std::ranges::find(kEndings, ending_in_lower_case(name)) != kEndings.end();
}

/// Folders, and what a Mac adds.
bool is_ignored(std::string_view name) {
  const std::string_view base = name.substr(name.rfind('/') + 1);
  return base.empty() || base.starts_with('.') || name.starts_with("__MACOSX/");
}

class ZipReader {
 public:
  ZipReader(std::string_view archive, std::size_t max_bytes, const std::stop_token& stop)
      : zip_(open(archive)), bytes_left_(max_bytes), stop_(stop) {
    const zip_int64_t count = zip_get_num_entries(zip_.get(), 0);
    if (count > static_cast<zip_int64_t>(kMaxEntries))
      refuse_zip("the archive has more than " + std::to_string(kMaxEntries) + " files");
    for (zip_int64_t i = 0; i < count; ++i) add_entry(static_cast<zip_uint64_t>(i));
  }

  [[nodiscard]] const std::vector<ZipEntry>& entries() const { return entries_; }

  [[nodiscard]] bool has_room_for(const ZipEntry& entry) const {
    return entry.bytes <= bytes_left_;
  }

  std::string read(const ZipEntry& entry) {
    if (entry.bytes > bytes_left_)
      throw Error(ErrorCode::body_too_large,
                  "the files in the archive are larger than a request may be; send less");
    bytes_left_ -= entry.bytes;
    const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> file(
        zip_fopen_index(zip_.get(), entry.number, 0), &zip_fclose);
    if (!file) refuse_zip(quoted_name(entry.name) + " cannot be read");
    std::string bytes;
    std::array<char, kInflatedAtOnce> part{};
    while (true) {
      throw_if_cancelled(stop_);
      const zip_int64_t size = zip_fread(file.get(), part.data(), part.size());
      if (size < 0) refuse_zip(quoted_name(entry.name) + " is damaged");
      if (size == 0) break;
      bytes.append(part.data(), static_cast<std::size_t>(size));
      if (bytes.size() > entry.bytes)
        refuse_zip(quoted_name(entry.name) + " is longer than announced");
    }
    if (bytes.size() != entry.bytes) refuse_zip(quoted_name(entry.name) + " is cut off");
    return bytes;
  }

 private:
  using Zip = std::unique_ptr<zip_t, decltype(&zip_discard)>;

  static Zip open(std::string_view archive) {
    zip_source_t* source = zip_source_buffer_create(archive.data(), archive.size(), 0, nullptr);
    if (source == nullptr) refuse_zip("the archive cannot be opened");
    zip_t* zip = zip_open_from_source(source, ZIP_RDONLY, nullptr);
    if (zip == nullptr) {
      zip_source_free(source);
      refuse_zip("the archive has no sound directory");
    }
    return {zip, &zip_discard};
  }

  void add_entry(zip_uint64_t number) {
    zip_stat_t stat;
    zip_stat_init(&stat);
    constexpr zip_uint64_t kNeeded =
        ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
    if (zip_stat_index(zip_.get(), number, 0, &stat) != 0 || (stat.valid & kNeeded) != kNeeded)
      refuse_zip("a file of the archive has no name or no size");
    if (is_ignored(stat.name) || is_link(number)) return;
    if (!is_plain_relative(stat.name)) refuse_zip("the path of a file leads out of the archive");
    if (stat.encryption_method != ZIP_EM_NONE) refuse_zip(quoted_name(stat.name) + " is encrypted");
    if (stat.comp_method != ZIP_CM_STORE && stat.comp_method != ZIP_CM_DEFLATE)
      refuse_zip(quoted_name(stat.name) + " is neither stored nor deflated");
    if (!names_.insert(stat.name).second)
      refuse_zip("the archive has " + quoted_name(stat.name) + " twice");
    entries_.push_back({number, stat.name, static_cast<std::size_t>(stat.size)});
  }

  [[nodiscard]] bool is_link(zip_uint64_t number) const {
    constexpr zip_uint32_t kKind = 0170000, kLink = 0120000;  // of a file's mode in Unix
    zip_uint8_t system = 0;
    zip_uint32_t attributes = 0;
    zip_file_get_external_attributes(zip_.get(), number, 0, &system, &attributes);
    return system == ZIP_OPSYS_UNIX && (attributes >> 16U & kKind) == kLink;
  }

  Zip zip_;
  std::size_t bytes_left_;
  std::stop_token stop_;
  std::vector<ZipEntry> entries_;
  std::set<std::string> names_;  ///< of them: readers of archives differ in which of two they take
};

const ZipEntry& find_document(const std::vector<ZipEntry>& entries, std::string_view archive) {
  const auto is_document = [](const ZipEntry& entry) { return is_asset_name(entry.name); };
  const auto found = std::ranges::find_if(entries, is_document);
  if (found == entries.end()) {
    refuse_other_formats(archive);  // USDZ and 3MF are archives, too
    throw Error(ErrorCode::unknown_format, "the zip archive is empty; put an asset into it");
  }
  const auto second = std::find_if(found + 1, entries.end(), is_document);
  if (second != entries.end())
    throw Error(ErrorCode::unknown_format, "the zip archive has several assets, such as " +
                                               quoted_name(found->name) + " and " +
                                               quoted_name(second->name) + "; put one into it");
  return *found;
}

}  // namespace

bool is_zip(std::string_view file) {
  return file.starts_with("PK\x03\x04") || file.starts_with("PK\x05\x06");
}

Unzipped unzip(std::string_view archive, std::size_t max_bytes, const std::stop_token& stop) {
  ZipReader reader(archive, max_bytes, stop);
  const ZipEntry& document = find_document(reader.entries(), archive);
  Unzipped unzipped{reader.read(document), {}};
  const std::string ending = ending_in_lower_case(document.name);
  const std::string folder = document.name.substr(0, document.name.rfind('/') + 1);
  const auto unpack = [&](const auto& is_wanted) {
    for (const ZipEntry& entry : reader.entries())
      if (&entry != &document && entry.name.starts_with(folder) && is_wanted(entry))
        unzipped.files.emplace(entry.name.substr(folder.size()), reader.read(entry));
  };
  if (ending == ".gltf") unpack([](const ZipEntry&) { return true; });
  if (ending != ".obj") return unzipped;
  for (const bool is_image : {false, true})  // which an OBJ can do without
    unpack([&](const ZipEntry& entry) {
      const std::string own = ending_in_lower_case(entry.name);
      return (is_image ? own == ".png" || own == ".jpg" || own == ".jpeg" : own == ".mtl") &&
             reader.has_room_for(entry);
    });
  return unzipped;
}

}  // namespace unwrapd::asset
