// The only file that knows tinygltf: without files, images and Draco, whose decoder behind it
// overflows its stack on damaged streams.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include "core/asset/reader/tinygltf.hpp"

#include <fstream>

#include <tiny_gltf.h>  // needs <fstream> in any case

#include <utility>

#include "core/base/cancel.hpp"

namespace unwrapd::asset::reader {
namespace {

constexpr std::size_t kSliceBytes = 65'536;

/// The model of a document with one list: `begin` and `end` enclose the slice.
tinygltf::Model model_of(const char* begin, const std::string& slice, const char* end) {
  const std::string document = std::string(R"({"asset":{"version":"2.0"},)") + begin + slice + end;
  tinygltf::Model model;
  std::string error, warning;
  tinygltf::TinyGLTF reader;
  if (!reader.LoadASCIIFromString(&model, &error, &warning, document.data(),
                                  static_cast<unsigned>(document.size()), ""))
    throw Error(ErrorCode::internal, "tinygltf refuses a checked document: " + error);
  return model;
}

/// A matrix's columns begin at multiples of 4 bytes.
std::size_t element_bytes(int type, std::size_t components, ComponentType component) {
  const std::size_t columns = type == TINYGLTF_TYPE_MAT2   ? 2
                              : type == TINYGLTF_TYPE_MAT3 ? 3
                              : type == TINYGLTF_TYPE_MAT4 ? 4
                                                           : 1;
  const std::size_t column = components / columns * component_bytes(component);
  return columns == 1 ? column : (column + 3) / 4 * 4 * columns;
}

Sparse sparse_of(const tinygltf::Accessor& read) {
  const auto size = [](int number) { return static_cast<std::size_t>(number); };
  return {.count = size(read.sparse.count),
          .index_view = size(read.sparse.indices.bufferView),
          .index_offset = size(read.sparse.indices.byteOffset),
          .index_type = static_cast<ComponentType>(read.sparse.indices.componentType),
          .value_view = size(read.sparse.values.bufferView),
          .value_offset = size(read.sparse.values.byteOffset)};
}

Accessor accessor_of(const tinygltf::Accessor& read) {
  Accessor accessor;
  accessor.type = static_cast<ComponentType>(read.componentType);
  accessor.components = static_cast<std::size_t>(
      tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(read.type)));
  accessor.element_bytes = element_bytes(read.type, accessor.components, accessor.type);
  accessor.count = read.count;
  accessor.offset = read.byteOffset;
  accessor.normalized = read.normalized;
  if (read.bufferView >= 0) accessor.view = static_cast<std::size_t>(read.bufferView);
  if (read.sparse.isSparse) accessor.sparse = sparse_of(read);
  return accessor;
}

Primitive primitive_of(const tinygltf::Primitive& read) {
  Primitive primitive;
  primitive.mode = static_cast<Mode>(read.mode);
  if (read.material >= 0) primitive.material = static_cast<std::size_t>(read.material);
  for (const auto& [name, accessor] : read.attributes)
    primitive.attributes.emplace_back(name, static_cast<std::size_t>(accessor));
  for (const auto& target : read.targets)
    for (const auto& [name, accessor] : target)
      primitive.targets.push_back(static_cast<std::size_t>(accessor));
  return primitive;
}

}  // namespace

void Members::begin(std::string_view name) {
  if (!members_.empty()) members_ += ',';
  members_.append("\"").append(name).append("\":");
}

void Members::add(std::string_view name, std::size_t value) {
  begin(name);
  members_ += std::to_string(value);
}

void Members::add(std::string_view name, std::string_view word) {
  begin(name);
  members_.append("\"").append(word).append("\"");
}

void Members::add(std::string_view name, const Members& object) {
  begin(name);
  members_ += object.text();
}

void Members::add_true(std::string_view name) {
  begin(name);
  members_ += "true";
}

void Members::add(std::string_view name, const std::vector<Members>& objects) {
  begin(name);
  members_ += '[';
  for (const Members& object : objects)
    members_.append(&object == objects.data() ? "" : ",").append(object.text());
  members_ += ']';
}

void Members::add_named(const std::string& name, std::size_t value) {
  if (!members_.empty()) members_ += ',';
  members_ += Json(name).dump() + ':' + std::to_string(value);
}

void Slices::add(const Check& check) {
  try {
    const std::string element = check().text();
    slice_.append(slice_.empty() ? "" : ",").append(element);
  } catch (const Error&) {
    end();
    throw;
  }
  if (slice_.size() >= kSliceBytes) end();
}

void Slices::end() {
  throw_if_cancelled(stop_);
  if (!slice_.empty()) take_(std::exchange(slice_, {}));
}

std::vector<View> views_of(const std::string& slice) {
  const tinygltf::Model model = model_of(R"("bufferViews":[)", slice, "]}");
  std::vector<View> views;
  for (const tinygltf::BufferView& read : model.bufferViews)
    views.push_back({.buffer = static_cast<std::size_t>(read.buffer),
                     .offset = read.byteOffset,
                     .length = read.byteLength});
  return views;
}

std::vector<Accessor> accessors_of(const std::string& slice) {
  const tinygltf::Model model = model_of(R"("accessors":[)", slice, "]}");
  std::vector<Accessor> accessors;
  for (const tinygltf::Accessor& read : model.accessors) accessors.push_back(accessor_of(read));
  return accessors;
}

std::vector<Primitive> primitives_of(const std::string& slice) {
  const tinygltf::Model model = model_of(R"("meshes":[{"primitives":[)", slice, "]}]}");
  std::vector<Primitive> primitives;
  for (const tinygltf::Primitive& read : model.meshes.at(0).primitives)
    primitives.push_back(primitive_of(read));
  return primitives;
}

}  // namespace unwrapd::asset::reader
