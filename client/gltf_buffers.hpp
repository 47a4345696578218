#pragma once
// Finds the external buffers of a .gltf, so that they can be uploaded with it.

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
/// Throws Failure{file} for a URI that leads out of the document's folder (absolute, with a scheme
/// or with ".."), and for a missing buffer.
std::vector<ExternalBuffer> external_buffers(const std::filesystem::path& document);

}  // namespace unwrapd::client
