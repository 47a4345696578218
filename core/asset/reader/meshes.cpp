// The primitives of meshes, and their references.
#include <algorithm>
#include <tuple>

#include "core/asset/reader/steps.hpp"
#include "core/asset/reader/tinygltf.hpp"

namespace unwrapd::asset::reader {
namespace {

constexpr std::size_t kMaxNames = 65'536;  // of a primitive: each takes 400 bytes in tinygltf

Members checked_attributes(const Gltf& gltf, const Node& node, std::size_t& names) {
  node.expect_object();
  Members attributes;
  for (const auto& [name, value] : node.json().get_ref<const Json::object_t&>()) {
    const Node accessor(value, node.place().at(std::string_view(name)));
    attributes.add_named(name, accessor.index(gltf.accessors.size(), "accessors"));
  }
  if ((names += node.json().size()) > kMaxNames)
    fail(ErrorCode::malformed_gltf, node.place(),
         "a primitive has at most 65,536 attributes, those of its morph targets too; split it");
  return attributes;
}

std::vector<Members> checked_targets(const Gltf& gltf, const Node& list, std::size_t& names) {
  std::vector<Members> targets;
  for (std::size_t i = 0; i < list.array_size(); ++i)
    targets.push_back(checked_attributes(gltf, list.at(i), names));
  return targets;
}

std::size_t checked_mode(const Node& node) {
  const std::size_t mode = node.number("mode", 4);
  if (mode <= 6) return mode;
  fail(ErrorCode::malformed_gltf, node.place().at("mode"),
       "a mode is from 0 to 6; export the asset again");
}

/// All members but Draco's. tinygltf refuses indices without a buffer view, so that we read them.
Members checked_primitive(const Gltf& gltf, const Node& node) {
  Members primitive;
  std::size_t names = 0;
  primitive.add("mode", checked_mode(node));
  primitive.add("attributes", checked_attributes(gltf, node.at("attributes"), names));
  if (const auto indices = node.find("indices"))
    static_cast<void>(indices->index(gltf.accessors.size(), "accessors"));
  if (const auto material = node.find("material"))
    primitive.add("material", material->index(list_size(gltf, "materials"), "materials"));
  if (const auto targets = node.find("targets"))
    primitive.add("targets", checked_targets(gltf, *targets, names));
  return primitive;
}

/// Sets the members that tinygltf did not get. tinygltf sorts attributes by name; here they return
/// to the author's order, in which they are written.
void complete(Primitive& primitive, const Node& node) {
  const auto by_name = [](const auto& attribute, const std::string& name) {
    return attribute.first < name;
  };
  const auto sorted = std::exchange(primitive.attributes, {});
  for (const auto& [name, value] : node.at("attributes").json().get_ref<const Json::object_t&>())
    primitive.attributes.push_back(*std::lower_bound(sorted.begin(), sorted.end(), name, by_name));
  if (const auto indices = node.find("indices")) primitive.indices = indices->number();
  for (const auto& [name, accessor] : primitive.attributes) {
    if (name != "POSITION") continue;
    primitive.position = accessor;
    primitive.has_triangles = primitive.mode >= Mode::triangles;
  }
}

codec::DracoSource read_draco(const Gltf& gltf, const Node& node, std::size_t primitive) {
  codec::DracoSource source;
  source.primitive = primitive;
  source.view = node.at("bufferView").index(gltf.views.size(), "buffer views");
  const Node attributes = node.at("attributes");
  attributes.expect_object();
  for (const auto& [name, id] : attributes.json().get_ref<const Json::object_t&>())
    source.attributes.emplace_back(
        name, Node(id, attributes.place().at(std::string_view(name))).number());
  return source;
}

std::optional<Node> draco_extension(const Node& primitive) {
  const auto extensions = primitive.find("extensions");
  return extensions ? extensions->find("KHR_draco_mesh_compression") : std::nullopt;
}

/// The Draco bitstream of a checked primitive, if it has one.
std::optional<codec::DracoSource> checked_draco(const Gltf& gltf, const Node& node,
                                                std::size_t primitive) {
  const auto draco = draco_extension(node);
  if (!draco) return std::nullopt;
  if (node.number("mode", 4) < std::size_t(Mode::triangles) ||
      !node.at("attributes").find("POSITION"))
    fail(ErrorCode::malformed_draco, node.place(),
         "only triangles can be compressed with Draco; export the asset again");
  return read_draco(gltf, *draco, primitive);
}

}  // namespace

std::size_t list_size(const Gltf& gltf, std::string_view name) {
  const auto list = Node(gltf.json).find(name);
  return list ? list->array_size() : 0;
}

std::vector<codec::DracoSource> read_meshes(Gltf& gltf) {
  std::vector<codec::DracoSource> sources;
  std::vector<std::pair<std::size_t, std::size_t>> numbers;  // of a primitive: mesh, place in it
  gltf.primitives.clear();
  Slices slices(
      [&](const std::string& slice) {
        for (Primitive& primitive : primitives_of(slice)) {
          std::tie(primitive.mesh, primitive.number) = numbers[gltf.primitives.size()];
          complete(primitive, Node(gltf.json)
                                  .at("meshes")
                                  .at(primitive.mesh)
                                  .at("primitives")
                                  .at(primitive.number));
          gltf.primitives.push_back(std::move(primitive));
        }
      },
      gltf.stop);
  const std::size_t mesh_count = list_size(gltf, "meshes");
  for (std::size_t i = 0; i < mesh_count; ++i) {
    const Node list = Node(gltf.json).at("meshes").at(i).at("primitives");
    for (std::size_t k = 0; k < list.array_size(); ++k)
      slices.add([&] {
        const Members primitive = checked_primitive(gltf, list.at(k));
        if (auto draco = checked_draco(gltf, list.at(k), numbers.size()))
          sources.push_back(std::move(*draco));
        numbers.emplace_back(i, k);
        return primitive;
      });
  }
  slices.end();
  return sources;
}

}  // namespace unwrapd::asset::reader
