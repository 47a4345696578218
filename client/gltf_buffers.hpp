#pragma once
// Finds the files beside a .gltf, so that they can be uploaded with it.

#include <filesystem>
#include <string>
#include <vector>

namespace unwrapd::client {

/// uri: as in the document, which is the name that the server looks for.
struct ExternalBuffer {
  std::string uri;
  std::filesystem::path file;
};

/// The external buffers of a .gltf, each once, in the document's order. Data URIs and a GLB's own
/// buffer are not external. A document that is not JSON has none; the server reports the error.
/// with_images: also the images that lie beside it; the server names those that do not.
/// Throws Failure{file} for a URI that leads out of the document's folder (absolute, with a scheme
/// or with ".."), and for a missing buffer.
std::vector<ExternalBuffer> external_buffers(const std::filesystem::path& document,
                                             bool with_images);

}  // namespace unwrapd::client
