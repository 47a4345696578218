// Buffer views and accessors. Every range is checked against the data that it refers to, by
// divisions that cannot overflow, before anything of its size is allocated.
#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "core/asset/reader/steps.hpp"
#include "core/asset/reader/tinygltf.hpp"

namespace unwrapd::asset::reader {
namespace {

constexpr std::size_t kMaxStride = 252;
constexpr std::size_t kMaxInt = std::numeric_limits<int>::max();  // tinygltf's of sparse accessors

constexpr std::array<std::string_view, 7> kElementTypes = {"SCALAR", "VEC2", "VEC3", "VEC4",
                                                           "MAT2",   "MAT3", "MAT4"};

std::string_view element_type(const Node& type) {
  for (const std::string_view known : kElementTypes)
    if (known == type.text()) return known;
  fail(ErrorCode::malformed_gltf, type.place(),
       "\"" + type.text() + "\" is no type of an accessor; export the asset again");
}

std::size_t component_type(const Node& type) {
  const std::size_t number = type.number();
  if (number < 5120 || number > 5126 || number == 5124)
    fail(ErrorCode::malformed_gltf, type.place(),
         std::to_string(number) + " is no component type; export the asset again");
  return number;
}

/// Whether `count` elements of `bytes` each, `stride` apart, from `offset` on, lie within `length`.
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

/// Not read by tinygltf, which refuses strides that are no multiple of 4.
std::size_t stride_of(const Node& view) {
  const auto stride = view.find("byteStride");
  if (!stride) return 0;
  if (stride->number() > kMaxStride)
    fail(ErrorCode::malformed_gltf, stride->place(),
         "a stride is at most 252 bytes; export the asset again");
  return stride->number();
}

Members checked_view(const Gltf& gltf, const Node& node) {
  Members view;
  view.add("buffer", node.at("buffer").index(gltf.buffers.size(), "buffers"));
  view.add("byteOffset", node.number("byteOffset", 0));
  view.add("byteLength", node.at("byteLength").number());
  static_cast<void>(stride_of(node));
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

std::size_t unsigned_type(const Node& node) {
  const std::size_t type = component_type(node);
  if (type == 5121 || type == 5123 || type == 5125) return type;
  fail(ErrorCode::malformed_gltf, node.place(),
       "indices are unsigned whole numbers; export the asset again");
}

/// The view and the offset of the indices or the values of a sparse accessor.
Members checked_part(const Gltf& gltf, const Node& node) {
  Members part;
  part.add("bufferView", node.at("bufferView").index(gltf.views.size(), "buffer views"));
  const std::size_t offset = node.number("byteOffset", 0);
  if (offset > kMaxInt) out_of_range(node.place(), "buffer view");
  part.add("byteOffset", offset);
  return part;
}

Members checked_sparse(const Gltf& gltf, const Node& node, std::size_t element_count) {
  const Node indices = node.at("indices");
  const Node values = node.at("values");
  const std::size_t count = node.at("count").number();
  Members checked_indices = checked_part(gltf, indices);
  checked_indices.add("componentType", unsigned_type(indices.at("componentType")));
  const Members checked_values = checked_part(gltf, values);
  if (count == 0 || count > std::min(element_count, kMaxInt))
    fail(ErrorCode::malformed_gltf, node.at("count").place(),
         "a sparse accessor replaces from one to all of its elements; export the asset again");
  Members sparse;
  sparse.add("count", count);
  sparse.add("indices", checked_indices);
  sparse.add("values", checked_values);
  return sparse;
}

Members checked_accessor(const Gltf& gltf, const Node& node) {
  Members accessor;
  accessor.add("type", element_type(node.at("type")));
  accessor.add("componentType", component_type(node.at("componentType")));
  const std::size_t count = node.at("count").number();
  accessor.add("count", count);
  accessor.add("byteOffset", node.number("byteOffset", 0));
  if (node.flag("normalized")) accessor.add_true("normalized");
  if (const auto view = node.find("bufferView"))
    accessor.add("bufferView", view->index(gltf.views.size(), "buffer views"));
  if (const auto sparse = node.find("sparse"))
    accessor.add("sparse", checked_sparse(gltf, *sparse, count));
  return accessor;
}

void check_sparse_ranges(const Gltf& gltf, const Accessor& accessor, const Place& place) {
  const auto check = [&](std::size_t view, std::size_t offset, std::size_t bytes,
                         std::string_view part) {
    if (!fits(gltf.views[view].length, offset, accessor.sparse->count, bytes, bytes))
      out_of_range(place.at(part), "buffer view");
  };
  const Sparse& sparse = *accessor.sparse;
  check(sparse.index_view, sparse.index_offset, component_bytes(sparse.index_type), "indices");
  check(sparse.value_view, sparse.value_offset, accessor.element_bytes, "values");
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

void check_accessor_range(const Gltf& gltf, const Accessor& accessor, const Place& place) {
  const View& view = gltf.views[*accessor.view];
  const std::size_t stride = view.stride != 0 ? view.stride : accessor.element_bytes;
  if (stride < accessor.element_bytes)
    fail(ErrorCode::malformed_gltf, place,
         "its elements are longer than the stride of its buffer view; export the asset again");
  if (!fits(view.length, accessor.offset, accessor.count, accessor.element_bytes, stride))
    out_of_range(place, "buffer view");
}

/// Entries are consecutive in the file, so that a document cannot have more of them than bytes. The
/// budget bounds the work for many accessors over the same bytes.
std::size_t sparse_budget(const Gltf& gltf) {
  std::size_t bytes = 0;
  for (const std::string& buffer : gltf.buffers) bytes += buffer.size();
  return bytes;
}

/// Checks the indices of a sparse accessor, and deducts them from the budget.
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
  Slices slices(
      [&](const std::string& slice) {
        for (View& view : views_of(slice)) {
          const Node node = list->at(gltf.views.size());
          view.stride = stride_of(node);
          if (!is_compressed(node)) check_view_range(gltf, view, node.place());
          gltf.views.push_back(view);
        }
      },
      gltf.stop);
  for (std::size_t i = 0; i < count; ++i)
    slices.add([&] { return checked_view(gltf, list->at(i)); });
  slices.end();
}

void read_accessors(Gltf& gltf) {
  const auto list = Node(gltf.json).find("accessors");
  const std::size_t count = list ? list->array_size() : 0;
  std::size_t budget = sparse_budget(gltf);
  gltf.accessors.clear();
  gltf.accessors.reserve(count);
  Slices slices(
      [&](const std::string& slice) {
        for (const Accessor& accessor : accessors_of(slice)) {
          const Place place = accessor_place(gltf.accessors.size());
          if (accessor.view) check_accessor_range(gltf, accessor, place);
          if (accessor.sparse) check_sparse_ranges(gltf, accessor, place.at("sparse"));
          gltf.accessors.push_back(accessor);
          if (accessor.sparse) spend(budget, gltf, gltf.accessors.size() - 1);
        }
      },
      gltf.stop);
  for (std::size_t i = 0; i < count; ++i)
    slices.add([&] { return checked_accessor(gltf, list->at(i)); });
  slices.end();
}

}  // namespace unwrapd::asset::reader
