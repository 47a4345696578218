// Meshes and nodes of the document: what refers to what. Nodes are only checked (a mesh is
// unwrapped once, however many nodes show it), by counting, without walking the graph recursively.
// A node with two parents is passed over: whoever reads the file shows it at both places.
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

/// The children of all nodes, one after another: those of node i begin at first[i].
struct Children {
  std::vector<std::size_t> node;
  std::vector<std::size_t> first = {0};
};

/// Nodes are taken away, parents before their children, until none is left (Kahn 1962). Linear
/// however many parents a node has: no path is walked twice.
void check_no_cycle(const Children& children, std::vector<std::size_t> parent_counts) {
  const std::size_t count = parent_counts.size();
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < count; ++i)
    if (parent_counts[i] == 0) free.push_back(i);
  for (std::size_t k = 0; k < free.size(); ++k)
    for (std::size_t c = children.first[free[k]]; c < children.first[free[k] + 1]; ++c)
      if (--parent_counts[children.node[c]] == 0) free.push_back(children.node[c]);
  if (free.size() == count) return;
  const auto in_cycle = std::find_if(parent_counts.begin(), parent_counts.end(),
                                     [](std::size_t parents) { return parents > 0; });
  fail(ErrorCode::malformed_gltf,
       Place().at("nodes").at(static_cast<std::size_t>(in_cycle - parent_counts.begin())),
       "the node is its own ancestor, or below one that is; break the cycle of children");
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

void check_nodes(Gltf& gltf) {
  const std::size_t count = list_size(gltf, "nodes");
  const std::size_t mesh_count = list_size(gltf, "meshes");
  std::vector<std::size_t> parent_counts(count, 0);
  Children children;
  for (std::size_t i = 0; i < count; ++i) {
    const Node node = Node(gltf.json).at("nodes").at(i);
    if (const auto mesh = node.find("mesh")) static_cast<void>(mesh->index(mesh_count, "meshes"));
    const auto list = node.find("children");
    const std::size_t child_count = list ? list->array_size() : 0;
    for (std::size_t k = 0; k < child_count; ++k) {
      children.node.push_back(list->at(k).index(count, "nodes"));
      ++parent_counts[children.node.back()];
    }
    children.first.push_back(children.node.size());
  }
  check_no_cycle(children, parent_counts);
  check_scenes(gltf, count);
  const auto shared = std::count_if(parent_counts.begin(), parent_counts.end(),
                                    [](std::size_t parents) { return parents > 1; });
  if (shared > 0) gltf.repairs.push_back({FileRepairKind::shared_nodes_kept, shared});
}

}  // namespace unwrapd::asset
