#include "core/asset/gltf/gltf.hpp"

#include <cassert>

#include "core/asset/base/bytes.hpp"

namespace unwrapd::asset {
namespace {

const char* view_bytes(const Gltf& gltf, std::size_t view) {
  return gltf.buffers[gltf.views[view].buffer].data() + gltf.views[view].offset;
}

}  // namespace

std::size_t component_bytes(ComponentType type) {
  switch (type) {
    case ComponentType::i8:
    case ComponentType::u8:
      return 1;
    case ComponentType::i16:
    case ComponentType::u16:
      return 2;
    case ComponentType::u32:
    case ComponentType::f32:
      return 4;
  }
  assert(false);
  return 4;
}

Place accessor_place(std::size_t accessor) { return Place().at("accessors").at(accessor); }

Place primitive_place(const Primitive& primitive) {
  return Place().at("meshes").at(primitive.mesh).at("primitives").at(primitive.number);
}

const char* dense_element(const Gltf& gltf, const Accessor& accessor, std::size_t element) {
  assert(accessor.view && element < accessor.count);
  const std::size_t given = gltf.views[*accessor.view].stride;
  const std::size_t stride = given != 0 ? given : accessor.element_bytes;
  return view_bytes(gltf, *accessor.view) + accessor.offset + element * stride;
}

std::size_t sparse_index(const Gltf& gltf, const Sparse& sparse, std::size_t k) {
  const std::size_t bytes = component_bytes(sparse.index_type);
  return load_unsigned(view_bytes(gltf, sparse.index_view) + sparse.index_offset + k * bytes,
                       bytes);
}

const char* sparse_value(const Gltf& gltf, const Accessor& accessor, std::size_t k) {
  assert(accessor.sparse && k < accessor.sparse->count);
  return view_bytes(gltf, accessor.sparse->value_view) + accessor.sparse->value_offset +
         k * accessor.element_bytes;
}

void add_buffer(Gltf& gltf, std::string bytes) {
  gltf.json["buffers"].push_back({{"byteLength", bytes.size()}});
  gltf.buffers.push_back(std::move(bytes));
  gltf.has_dead_bytes = true;
}

}  // namespace unwrapd::asset
