#pragma once
// Finds the files beside a .gltf or an OBJ, so that they can be uploaded with it.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace unwrapd::client {

/// uri: as in the document, which is the name that the server looks for.
struct FileBeside {
  std::string uri;
  std::filesystem::path file;
};

/// The path that a URI names, below the folder of its document; none if it leads out of that.
std::optional<std::filesystem::path> path_below(const std::string& uri);

/// The images of a .gltf that are in files of their own, each once. A document that is not JSON has
/// none.
std::vector<std::string> image_uris(const std::filesystem::path& gltf);

/// What of it the result needs, besides the buffers of a .gltf.
struct WantedFiles {
  bool images = false;     ///< of a .gltf: a GLB contains them
  bool materials = false;  ///< of an OBJ: what mtllib names, and the images that these name
};

/// The files beside a document, each once, in the document's order. Data URIs and a GLB's own
/// buffer are not beside it. A document that is not JSON has none; the server reports the error.
/// Images and materials that do not lie there are left out; the server names them.
/// Throws Failure{file} for the URI of a buffer that leads out of the document's folder (absolute,
/// with a scheme or with ".."), and for a missing buffer.
std::vector<FileBeside> files_beside(const std::filesystem::path& document, WantedFiles wanted);

}  // namespace unwrapd::client
