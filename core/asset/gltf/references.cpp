#include "core/asset/gltf/references.hpp"

namespace unwrapd::asset {
namespace {

/// A member of an object; null if it is not an object or has no such member.
template <class Value>
Value* member(Value& object, std::string_view name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

template <class Value, class Visit>
void for_each(Value* list, const Visit& visit) {
  if (list == nullptr || !list->is_structured()) return;
  for (auto& value : *list) visit(value);
}

template <class Value, class Visit>
void visit_index(Value* index, const Visit& visit) {
  if (index != nullptr && index->is_number()) visit(*index);
}

template <class Value, class Visit>
void visit_primitive(Value& primitive, const Visit& visit) {
  const auto visit_value = [&](auto& value) { visit_index(&value, visit); };
  for_each(member(primitive, "attributes"), visit_value);
  visit_index(member(primitive, "indices"), visit);
  for_each(member(primitive, "targets"), [&](auto& target) { for_each(&target, visit_value); });
}

template <class Value, class Visit>
void visit_primitives(Value& document, const Visit& visit) {
  for_each(member(document, "meshes"),
           [&](auto& mesh) { for_each(member(mesh, "primitives"), visit); });
}

template <class Value, class Visit>
void visit_accessors(Value& document, const Visit& visit) {
  visit_primitives(document, [&](auto& primitive) { visit_primitive(primitive, visit); });
  for_each(member(document, "animations"), [&](auto& animation) {
    for_each(member(animation, "samplers"), [&](auto& sampler) {
      visit_index(member(sampler, "input"), visit);
      visit_index(member(sampler, "output"), visit);
    });
  });
  for_each(member(document, "skins"),
           [&](auto& skin) { visit_index(member(skin, "inverseBindMatrices"), visit); });
}

template <class Value, class Visit>
void visit_other_views(Value& document, const Visit& visit) {
  visit_primitives(document, [&](auto& primitive) {
    auto* extensions = member(primitive, "extensions");
    auto* draco =
        extensions == nullptr ? nullptr : member(*extensions, "KHR_draco_mesh_compression");
    if (draco != nullptr) visit_index(member(*draco, "bufferView"), visit);
  });
  for_each(member(document, "images"),
           [&](auto& image) { visit_index(member(image, "bufferView"), visit); });
}

template <class Value, class Visit>
void visit_views(Value& document, const Visit& visit) {
  for_each(member(document, "accessors"), [&](auto& accessor) {
    visit_index(member(accessor, "bufferView"), visit);
    auto* sparse = member(accessor, "sparse");
    if (sparse == nullptr) return;
    for (const char* part : {"indices", "values"})
      if (auto* node = member(*sparse, part)) visit_index(member(*node, "bufferView"), visit);
  });
  visit_other_views(document, visit);
}

}  // namespace

std::vector<std::size_t> count_accessor_references(const Json& document, std::size_t count) {
  std::vector<std::size_t> references(count);
  visit_accessors(document, [&](const Json& index) {
    const double value = index.get<double>();
    if (value >= 0 && value < static_cast<double>(count)) ++references[index.get<std::size_t>()];
  });
  return references;
}

void for_each_accessor_reference(Json& document, const std::function<void(Json&)>& visit) {
  visit_accessors(document, visit);
}

void for_each_view_reference(Json& document, const std::function<void(Json&)>& visit) {
  visit_views(document, visit);
}

void for_each_view_reference(const Json& document, const std::function<void(const Json&)>& visit) {
  visit_views(document, visit);
}

void for_each_other_view_reference(const Json& document,
                                   const std::function<void(const Json&)>& visit) {
  visit_other_views(document, visit);
}

}  // namespace unwrapd::asset
