#include "core/asset/asset.hpp"

#include <cassert>
#include <utility>

#include "core/asset/convert.hpp"
#include "core/asset/document.hpp"
#include "core/asset/patch.hpp"
#include "core/asset/read_gltf.hpp"
#include "core/asset/recognise.hpp"

namespace unwrapd::asset {

Asset::Asset(std::unique_ptr<Document> document) : document_(std::move(document)) {}
Asset::Asset(Asset&&) noexcept = default;
Asset& Asset::operator=(Asset&&) noexcept = default;
Asset::~Asset() = default;

Format Asset::format() const { return document_->format; }

std::span<const Surface> Asset::surfaces() const { return document_->surfaces; }

Asset read(const Input& input, const ReadLimits& limits) {
  auto document = std::make_unique<Document>();
  document->format = recognise(input.document);
  if (document->format == Format::obj) {
    document->surfaces.resize(1);
    document->source = read_obj(input.document, limits, document->surfaces.front());
  } else {
    document->source = read_gltf(input, document->format, limits, document->surfaces);
  }
  return Asset(std::move(document));
}

std::string write(const Asset& asset, std::span<const UnwrappedSurface> unwrapped, Format output) {
  const Document& document = asset.document();
  assert(unwrapped.size() == document.surfaces.size());
  if (const Obj* obj = std::get_if<Obj>(&document.source))
    return output == Format::obj
               ? write_obj(*obj, unwrapped.front())
               : obj_as_gltf(*obj, document.surfaces.front(), unwrapped.front(), output);
  const Gltf& gltf = std::get<Gltf>(document.source);
  return output == Format::obj ? gltf_as_obj(gltf, document.surfaces, unwrapped)
                               : assemble(gltf, patch(gltf, unwrapped), output);
}

}  // namespace unwrapd::asset
