#include "client/gltf_buffers.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

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

ExternalBuffer locate(const std::string& uri, const fs::path& folder) {
  const std::string name = percent_decoded(uri);
  if (leads_outside(name))
    throw Failure(ExitCode::file, "The buffer \"" + uri +
                                      "\" lies outside the document's folder; copy it beside the "
                                      "document and refer to it by its name alone.");
  ExternalBuffer buffer{uri, folder / name};
  file_bytes(buffer.file);
  return buffer;
}

/// uri of a buffer; empty if it is missing or of another type.
std::string uri_of(const nlohmann::json& buffer) {
  if (!buffer.is_object()) return {};
  const auto uri = buffer.find("uri");
  return uri != buffer.end() && uri->is_string() ? uri->get<std::string>() : std::string();
}

}  // namespace

std::vector<ExternalBuffer> external_buffers(const fs::path& document, bool with_images) {
  if (document.extension() != ".gltf") return {};
  const auto json = nlohmann::json::parse(read_file(document), nullptr, false);
  std::vector<ExternalBuffer> buffers;
  const auto take = [&](const char* list, bool must_exist) {
    if (!json.is_object() || !json.contains(list) || !json[list].is_array()) return;
    for (const nlohmann::json& entry : json[list]) {
      const std::string uri = uri_of(entry);
      if (uri.empty() || uri.starts_with("data:")) continue;
      if (std::ranges::find(buffers, uri, &ExternalBuffer::uri) != buffers.end()) continue;
      try {
        buffers.push_back(locate(uri, document.parent_path()));
      } catch (const Failure&) {
        if (must_exist) throw;
      }
    }
  };
  take("buffers", true);
  if (with_images) take("images", false);
  return buffers;
}

}  // namespace unwrapd::client
