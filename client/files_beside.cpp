#include "client/files_beside.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "client/failure.hpp"
#include "client/files.hpp"
#include "client/formats.hpp"

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
  const std::optional<fs::path> name = path_below(uri);
  if (!name)
    throw Failure(ExitCode::file, "The buffer \"" + uri +
                                      "\" lies outside the document's folder; copy it beside the "
                                      "document and refer to it by its name alone.");
  FileBeside buffer{uri, folder / *name};
  file_bytes(buffer.file);
  return buffer;
}

/// uri of a buffer or an image; empty if it is missing, of another type, or holds the data itself.
std::string uri_of(const nlohmann::json& entry) {
  if (!entry.is_object()) return {};
  const auto found = entry.find("uri");
  if (found == entry.end() || !found->is_string()) return {};
  const auto& uri = found->get_ref<const std::string&>();
  return uri.starts_with("data:") ? std::string() : uri;
}

/// The URIs of a document's buffers or images, each once.
std::vector<std::string> uris_in(const nlohmann::json& document, const char* list) {
  std::vector<std::string> uris;
  if (!document.is_object() || !document.contains(list) || !document[list].is_array()) return uris;
  for (const nlohmann::json& entry : document[list]) {
    std::string uri = uri_of(entry);
    if (!uri.empty() && std::ranges::find(uris, uri) == uris.end()) uris.push_back(std::move(uri));
  }
  return uris;
}

nlohmann::json read_json(const fs::path& document) {
  return nlohmann::json::parse(read_file(document), nullptr, false);
}

std::vector<FileBeside> files_of_gltf(const fs::path& document, bool with_images) {
  const nlohmann::json json = read_json(document);
  std::vector<FileBeside> files;
  for (const std::string& uri : uris_in(json, "buffers"))
    files.push_back(locate(uri, document.parent_path()));
  if (!with_images) return files;
  for (const std::string& uri : uris_in(json, "images")) {
    const std::optional<fs::path> name = path_below(uri);
    std::error_code none;
    const bool is_there = name && fs::is_regular_file(document.parent_path() / *name, none);
    if (is_there && std::ranges::find(files, uri, &FileBeside::uri) == files.end())
      files.push_back({uri, document.parent_path() / *name});
  }
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

std::optional<fs::path> path_below(const std::string& uri) {
  std::string name = percent_decoded(uri);
  if (leads_outside(name)) return std::nullopt;
  return fs::path(std::move(name));
}

std::vector<std::string> image_uris(const fs::path& gltf) {
  std::vector<std::string> uris = uris_in(read_json(gltf), "images");
  std::erase_if(uris, [](const std::string& uri) { return uri.find("://") != std::string::npos; });
  return uris;
}

std::vector<FileBeside> files_beside(const fs::path& document, WantedFiles wanted) {
  const std::string extension = extension_of(document);
  if (extension == "gltf") return files_of_gltf(document, wanted.images);
  if (extension == "obj" && wanted.materials) return files_of_obj(document);
  return {};
}

}  // namespace unwrapd::client
