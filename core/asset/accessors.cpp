// Buffer views and accessors: every range is proved to lie within what it refers to, by divisions
// that cannot overflow, before anything of its size exists.
#include <array>
#include <string_view>

#include "core/asset/gltf_steps.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::size_t kMaxStride = 252;

struct ElementType {
  std::string_view name;
  std::size_t rows;
  std::size_t columns;
};

constexpr std::array<ElementType, 7> kElementTypes = {{{"SCALAR", 1, 1},
                                                       {"VEC2", 2, 1},
                                                       {"VEC3", 3, 1},
                                                       {"VEC4", 4, 1},
                                                       {"MAT2", 2, 2},
                                                       {"MAT3", 3, 3},
                                                       {"MAT4", 4, 4}}};

ElementType element_type(const Node& type) {
  for (const ElementType& known : kElementTypes)
    if (known.name == type.text()) return known;
  fail(ErrorCode::malformed_gltf, type.place(),
       "\"" + type.text() + "\" is no type of an accessor; export the asset again");
}

ComponentType component_type(const Node& type) {
  const std::size_t number = type.number();
  if (number < 5120 || number > 5126 || number == 5124)
    fail(ErrorCode::malformed_gltf, type.place(),
         std::to_string(number) + " is no component type; export the asset again");
  return static_cast<ComponentType>(number);
}

/// A matrix's columns begin at multiples of 4 bytes.
std::size_t element_bytes(const ElementType& element, ComponentType type) {
  const std::size_t column = element.rows * component_bytes(type);
  return element.columns == 1 ? column : (column + 3) / 4 * 4 * element.columns;
}

/// `count` elements of `bytes` each, `stride` apart, from `offset` on: do they lie in `length`?
bool fits(std::size_t length, std::size_t offset, std::size_t count, std::size_t bytes,
          std::size_t stride) {
  if (count == 0) return offset <= length;
  if (offset > length || bytes > length - offset) return false;
  return (count - 1) <= (length - offset - bytes) / stride;
}

[[noreturn]] void out_of_range(const Place& place, std::string_view container) {
  fail(ErrorCode::malformed_gltf, place,
       "it reaches beyond the end of its " + std::string(container) + "; export the asset again");
}

View read_view(const Gltf& gltf, const Node& node) {
  View view;
  node.expect_object();
  view.buffer = node.at("buffer").index(gltf.buffers.size(), "buffers");
  view.offset = node.number("byteOffset", 0);
  view.length = node.at("byteLength").number();
  if (const auto stride = node.find("byteStride")) {
    view.stride = stride->number();
    if (view.stride > kMaxStride)
      fail(ErrorCode::malformed_gltf, stride->place(),
           "a stride is at most 252 bytes; export the asset again");
  }
  return view;
}

void check_view_range(const Gltf& gltf, const View& view, const Place& place) {
  if (!fits(gltf.buffers[view.buffer].size(), view.offset, view.length, 1, 1))
    out_of_range(place, "buffer");
}

bool is_compressed(const Node& view) {
  const auto extensions = view.find("extensions");
  return extensions && (extensions->find("EXT_meshopt_compression") ||
                        extensions->find("KHR_meshopt_compression"));
}

ComponentType unsigned_type(const Node& node) {
  const ComponentType type = component_type(node);
  if (type != ComponentType::u8 && type != ComponentType::u16 && type != ComponentType::u32)
    fail(ErrorCode::malformed_gltf, node.place(),
         "indices are unsigned whole numbers; export the asset again");
  return type;
}

/// A tight run of `count` elements of `bytes` each in the view that `part` names.
void check_sparse_part(const Gltf& gltf, const Node& part, std::size_t count, std::size_t bytes) {
  const View& view = gltf.views[part.at("bufferView").number()];
  if (!fits(view.length, part.number("byteOffset", 0), count, bytes, bytes))
    out_of_range(part.place(), "buffer view");
}

void check_sparse_indices(const Gltf& gltf, const Accessor& accessor, const Place& place) {
  const Sparse& sparse = *accessor.sparse;
  for (std::size_t k = 0; k < sparse.count; ++k) {
    const std::size_t index = sparse_index(gltf, sparse, k);
    const bool ascending = k == 0 || index > sparse_index(gltf, sparse, k - 1);
    if (index < accessor.count && ascending) continue;
    fail(ErrorCode::malformed_gltf, place,
         "sparse indices must ascend and stay below the accessor's count; export the asset again");
  }
}

Sparse read_sparse(const Gltf& gltf, const Accessor& accessor, const Node& node) {
  const Node indices = node.at("indices");
  const Node values = node.at("values");
  Sparse sparse;
  sparse.count = node.at("count").number();
  sparse.index_view = indices.at("bufferView").index(gltf.views.size(), "buffer views");
  sparse.index_offset = indices.number("byteOffset", 0);
  sparse.index_type = unsigned_type(indices.at("componentType"));
  sparse.value_view = values.at("bufferView").index(gltf.views.size(), "buffer views");
  sparse.value_offset = values.number("byteOffset", 0);
  if (sparse.count == 0 || sparse.count > accessor.count)
    fail(ErrorCode::malformed_gltf, node.at("count").place(),
         "a sparse accessor replaces from one to all of its elements; export the asset again");
  check_sparse_part(gltf, indices, sparse.count, component_bytes(sparse.index_type));
  check_sparse_part(gltf, values, sparse.count, accessor.element_bytes);
  return sparse;
}

void check_accessor_range(const Gltf& gltf, const Accessor& accessor, const Place& place) {
  const View& view = gltf.views[*accessor.view];
  const std::size_t stride = view.stride != 0 ? view.stride : accessor.element_bytes;
  if (stride < accessor.element_bytes)
    fail(ErrorCode::malformed_gltf, place,
         "its elements are longer than the stride of its buffer view; export the asset again");
  if (!fits(view.length, accessor.offset, accessor.count, accessor.element_bytes, stride))
    out_of_range(place, "buffer view");
}

Accessor read_accessor(const Gltf& gltf, const Node& node) {
  Accessor accessor;
  const ElementType element = element_type(node.at("type"));
  accessor.type = component_type(node.at("componentType"));
  accessor.components = element.rows * element.columns;
  accessor.element_bytes = element_bytes(element, accessor.type);
  accessor.count = node.at("count").number();
  accessor.offset = node.number("byteOffset", 0);
  accessor.normalized = node.flag("normalized");
  if (const auto view = node.find("bufferView")) {
    accessor.view = view->index(gltf.views.size(), "buffer views");
    check_accessor_range(gltf, accessor, node.place());
  }
  if (const auto sparse = node.find("sparse"))
    accessor.sparse = read_sparse(gltf, accessor, *sparse);
  return accessor;
}

/// Entries lie in the file side by side, so that there are no more of them than bytes; many
/// accessors over the same bytes would only make us count for hours.
std::size_t sparse_budget(const Gltf& gltf) {
  std::size_t bytes = 0;
  for (const std::string& buffer : gltf.buffers) bytes += buffer.size();
  return bytes;
}

/// Checks the indices of a sparse accessor, if the budget allows.
void spend(std::size_t& budget, const Gltf& gltf, std::size_t accessor) {
  const Sparse& sparse = *gltf.accessors[accessor].sparse;
  const Place place = accessor_place(accessor).at("sparse");
  if (sparse.count > budget)
    fail(ErrorCode::malformed_gltf, place,
         "too many sparse accessors share the same bytes; export the asset again");
  budget -= sparse.count;
  check_sparse_indices(gltf, gltf.accessors[accessor], place);
}

}  // namespace

void read_views(Gltf& gltf) {
  const auto list = Node(gltf.json).find("bufferViews");
  const std::size_t count = list ? list->array_size() : 0;
  gltf.views.clear();
  gltf.views.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    gltf.views.push_back(read_view(gltf, list->at(i)));
    if (!is_compressed(list->at(i))) check_view_range(gltf, gltf.views.back(), list->at(i).place());
  }
}

void read_accessors(Gltf& gltf) {
  const auto list = Node(gltf.json).find("accessors");
  const std::size_t count = list ? list->array_size() : 0;
  std::size_t budget = sparse_budget(gltf);
  gltf.accessors.clear();
  gltf.accessors.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    gltf.accessors.push_back(read_accessor(gltf, list->at(i)));
    if (gltf.accessors.back().sparse) spend(budget, gltf, i);
  }
}

}  // namespace unwrapd::asset
