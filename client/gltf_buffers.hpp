#pragma once
// The files that a .gltf keeps its numbers in: found beside it, so that they can travel with it.

#include <filesystem>
#include <string>
#include <vector>

namespace unwrapd::client {

/// uri: as the document writes it, which is the name that the server looks for.
struct ExternalBuffer {
  std::string uri;
  std::filesystem::path file;
};

/// The external buffers of a .gltf, each once, in the document's order. Data URIs and a GLB's own
/// buffer need none. A document that is no JSON has none: the server says what is wrong with it.
/// Throws Failure{file} for a URI that leads out of the document's folder (absolute, with a scheme
/// or with ".."), and for a buffer that is not there.
std::vector<ExternalBuffer> external_buffers(const std::filesystem::path& document);

}  // namespace unwrapd::client
