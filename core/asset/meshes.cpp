// Meshes and nodes of the document: what refers to what. Nodes are only checked (a mesh is
// unwrapped once, however many nodes show it), by counting, without walking the graph recursively.
#include <algorithm>

#include "core/asset/gltf_steps.hpp"

namespace unwrapd::asset {
namespace {

std::size_t list_size(const Gltf& gltf, std::string_view name) {
  const auto list = Node(gltf.json).find(name);
  return list ? list->array_size() : 0;
}

using NamedIndices = std::vector<std::pair<std::string, std::size_t>>;

NamedIndices read_attributes(const Gltf& gltf, const Node& node) {
  node.expect_object();
  NamedIndices attributes;
  for (const auto& [name, value] : node.json().get_ref<const Json::object_t&>())
    attributes.emplace_back(name, Node(value, node.place().at(std::string_view(name)))
                                      .index(gltf.accessors.size(), "accessors"));
  return attributes;
}

void read_targets(const Gltf& gltf, const Node& list, Primitive& primitive) {
  for (std::size_t i = 0; i < list.array_size(); ++i)
    for (const auto& [name, accessor] : read_attributes(gltf, list.at(i)))
      primitive.targets.push_back(accessor);
}

Mode read_mode(const Node& node) {
  const std::size_t mode = node.number("mode", 4);
  if (mode > 6)
    fail(ErrorCode::malformed_gltf, node.place().at("mode"),
         "a mode is from 0 to 6; export the asset again");
  return static_cast<Mode>(mode);
}

DracoSource read_draco(const Gltf& gltf, const Node& node, std::size_t primitive) {
  DracoSource source;
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

Primitive read_primitive(const Gltf& gltf, const Node& node) {
  Primitive primitive;
  primitive.mode = read_mode(node);
  primitive.attributes = read_attributes(gltf, node.at("attributes"));
  if (const auto indices = node.find("indices"))
    primitive.indices = indices->index(gltf.accessors.size(), "accessors");
  if (const auto material = node.find("material"))
    primitive.material = material->index(list_size(gltf, "materials"), "materials");
  if (const auto targets = node.find("targets")) read_targets(gltf, *targets, primitive);
  for (const auto& [name, accessor] : primitive.attributes) {
    if (name != "POSITION") continue;
    primitive.position = accessor;
    primitive.has_triangles = primitive.mode >= Mode::triangles;
  }
  return primitive;
}

/// Marks the node's children; a node that already has a parent is refused.
void adopt_children(const Node& node, std::size_t parent, std::vector<std::size_t>& parents) {
  const auto children = node.find("children");
  const std::size_t count = children ? children->array_size() : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Node child = children->at(i);
    std::size_t& slot = parents[child.index(parents.size(), "nodes")];
    if (slot != parents.size())
      fail(ErrorCode::malformed_gltf, child.place(),
           "a node may have one parent only, and this one has two; give each parent its own copy");
    slot = parent;
  }
}

/// With one parent each, the nodes that no chain of parents leads out of lie on a cycle.
void check_no_cycle(const std::vector<std::size_t>& parents) {
  const std::size_t root = parents.size();
  std::vector<char> known(parents.size(), 0);  // known to lead to a root
  std::vector<std::size_t> chain;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    chain.clear();
    std::size_t node = i;
    while (node != root && known[node] == 0 && chain.size() <= parents.size()) {
      chain.push_back(node);
      node = parents[node];
    }
    if (chain.size() > parents.size())
      fail(ErrorCode::malformed_gltf, Place().at("nodes").at(i),
           "the node is its own ancestor; break the cycle of children");
    for (const std::size_t visited : chain) known[visited] = 1;
  }
}

void check_scenes(const Gltf& gltf, std::size_t node_count) {
  const auto scenes = Node(gltf.json).find("scenes");
  const std::size_t count = scenes ? scenes->array_size() : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto nodes = scenes->at(i).find("nodes");
    for (std::size_t k = 0; nodes && k < nodes->array_size(); ++k)
      static_cast<void>(nodes->at(k).index(node_count, "nodes"));
  }
}

}  // namespace

std::vector<DracoSource> read_meshes(Gltf& gltf) {
  std::vector<DracoSource> sources;
  gltf.primitives.clear();
  const std::size_t mesh_count = list_size(gltf, "meshes");
  for (std::size_t i = 0; i < mesh_count; ++i) {
    const Node list = Node(gltf.json).at("meshes").at(i).at("primitives");
    for (std::size_t k = 0; k < list.array_size(); ++k) {
      Primitive primitive = read_primitive(gltf, list.at(k));
      primitive.mesh = i;
      primitive.number = k;
      if (const auto draco = draco_extension(list.at(k))) {
        if (!primitive.has_triangles)
          fail(ErrorCode::malformed_draco, list.at(k).place(),
               "only triangles can be compressed with Draco; export the asset again");
        sources.push_back(read_draco(gltf, *draco, gltf.primitives.size()));
      }
      gltf.primitives.push_back(std::move(primitive));
    }
  }
  return sources;
}

void check_nodes(const Gltf& gltf) {
  const std::size_t count = list_size(gltf, "nodes");
  const std::size_t mesh_count = list_size(gltf, "meshes");
  std::vector<std::size_t> parents(count, count);
  for (std::size_t i = 0; i < count; ++i) {
    const Node node = Node(gltf.json).at("nodes").at(i);
    if (const auto mesh = node.find("mesh")) static_cast<void>(mesh->index(mesh_count, "meshes"));
    adopt_children(node, i, parents);
  }
  check_no_cycle(parents);
  check_scenes(gltf, count);
}

}  // namespace unwrapd::asset
