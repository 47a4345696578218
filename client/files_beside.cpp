#include "client/files_beside.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "client/failure.hpp"
#include "client/files.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

/// Decodes %20 and its like (RFC 3986). A lone percent sign stays.
std::string percent_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const bool escape = text[i] == '%' && i + 2 < text.size() &&
                        std::from_chars(&text[i + 1], &text[i] + 3, value, 16).ptr == &text[i] + 3;
    decoded += escape ? static_cast<char>(value) : text[i];
    if (escape) i += 2;
  }
  return decoded;
}

bool leads_outside(const std::string& name) {
  const fs::path path(name);
  return path.empty() || path.is_absolute() || name.find("://") != std::string::npos ||
         std::ranges::find(path, fs::path("..")) != path.end();
}

FileBeside locate(const std::string& uri, const fs::path& folder) {
  const std::string name = percent_decoded(uri);
  if (leads_outside(name))
    throw Failure(ExitCode::file, "The buffer \"" + uri +
                                      "\" lies outside the document's folder; copy it beside the "
                                      "document and refer to it by its name alone.");
  FileBeside buffer{uri, folder / name};
  file_bytes(buffer.file);
  return buffer;
}

/// uri of a buffer; empty if it is missing or of another type.
std::string uri_of(const nlohmann::json& buffer) {
  if (!buffer.is_object()) return {};
  const auto uri = buffer.find("uri");
  return uri != buffer.end() && uri->is_string() ? uri->get<std::string>() : std::string();
}

/// Adds the file of this URI, once.
void take(std::vector<FileBeside>& files, const std::string& uri, const fs::path& folder) {
  if (std::ranges::find(files, uri, &FileBeside::uri) == files.end())
    files.push_back(locate(uri, folder));
}

std::vector<FileBeside> files_of_gltf(const fs::path& document, bool with_images) {
  const auto json = nlohmann::json::parse(read_file(document), nullptr, false);
  std::vector<FileBeside> files;
  const auto take_all = [&](const char* list, bool must_exist) {
    if (!json.is_object() || !json.contains(list) || !json[list].is_array()) return;
    for (const nlohmann::json& entry : json[list]) {
      const std::string uri = uri_of(entry);
      if (uri.empty() || uri.starts_with("data:")) continue;
      try {
        take(files, uri, document.parent_path());
      } catch (const Failure&) {
        if (must_exist) throw;
      }
    }
  };
  take_all("buffers", true);
  if (with_images) take_all("images", false);
  return files;
}

/// The first word of a line, and the rest without spaces around it.
std::pair<std::string, std::string> statement(const std::string& line) {
  constexpr const char* kSpaces = " \t\r";
  const std::size_t begin = line.find_first_not_of(kSpaces);
  if (begin == std::string::npos) return {};
  const std::size_t end = std::min(line.find_first_of(kSpaces, begin), line.size());
  const std::size_t rest = line.find_first_not_of(kSpaces, end);
  if (rest == std::string::npos) return {line.substr(begin, end - begin), ""};
  return {line.substr(begin, end - begin),
          line.substr(rest, line.find_last_not_of(kSpaces) + 1 - rest)};
}

/// Adds the file that text ends with: names may have spaces, and options may stand before them.
void take_last(std::vector<FileBeside>& files, std::string text, const fs::path& folder) {
  std::ranges::replace(text, '\\', '/');
  while (!text.empty()) {
    std::error_code ignored;
    if (!leads_outside(text) && fs::is_regular_file(folder / text, ignored)) {
      if (std::ranges::find(files, text, &FileBeside::uri) == files.end())
        files.push_back({text, folder / text});
      return;
    }
    text = statement(text).second;
  }
}

bool names_image(const std::string& keyword) {
  return keyword.starts_with("map_") || keyword.starts_with("norm") || keyword.starts_with("bump");
}

/// mtllib stands before the first face.
std::vector<FileBeside> files_of_obj(const fs::path& document) {
  std::vector<FileBeside> files;
  std::ifstream obj(document, std::ios::binary);
  for (std::string line; std::getline(obj, line);) {
    const auto [keyword, rest] = statement(line);
    if (keyword == "f") break;
    if (keyword == "mtllib") take_last(files, rest, document.parent_path());
  }
  const std::size_t libraries = files.size();
  for (std::size_t k = 0; k < libraries; ++k) {
    std::ifstream mtl(files[k].file, std::ios::binary);
    for (std::string line; std::getline(mtl, line);)
      if (const auto [keyword, rest] = statement(line); names_image(keyword))
        take_last(files, rest, document.parent_path());
  }
  return files;
}

}  // namespace

std::vector<FileBeside> files_beside(const fs::path& document, WantedFiles wanted) {
  if (document.extension() == ".gltf") return files_of_gltf(document, wanted.images);
  if (document.extension() == ".obj" && wanted.materials) return files_of_obj(document);
  return {};
}

}  // namespace unwrapd::client
