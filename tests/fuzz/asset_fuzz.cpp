// Any bytes at all through the whole of asset: an answer in every format, or an Error.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/asset/asset.hpp"
#include "core/error.hpp"

namespace {

using unwrapd::Index;
using unwrapd::Surface;
using unwrapd::UnwrappedSurface;

/// Every second face gets vertices of its own.
UnwrappedSurface cut(const Surface& surface) {
  UnwrappedSurface result;
  result.faces = surface.mesh.faces;
  for (Index i = 0; i < surface.mesh.vertex_count(); ++i) result.source.push_back(i);
  for (std::size_t t = 0; t < result.faces.size(); t += 2)
    for (Index& corner : result.faces[t]) {
      result.source.push_back(corner);
      corner = static_cast<Index>(result.source.size() - 1);
    }
  result.uv.resize(result.source.size(), unwrapd::Vec2(0.25, 0.75));
  return result;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace asset = unwrapd::asset;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const asset::Asset read =
        asset::read({bytes, {}}, {.max_vertices = 20'000, .max_faces = 20'000});
    std::vector<UnwrappedSurface> unwrapped;
    for (const Surface& surface : read.surfaces()) unwrapped.push_back(cut(surface));
    for (const auto format : {asset::Format::glb, asset::Format::gltf, asset::Format::obj}) {
      const std::string answer = asset::write(read, unwrapped, format);
      if (answer.empty()) std::abort();
      if (asset::read({answer, {}}, {}).surfaces().empty()) std::abort();  // our own, read again
    }
  } catch (const unwrapd::Error&) {
    return 0;
  }
  return 0;
}
