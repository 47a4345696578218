// The nodes of a document: their references, and where they put meshes. A node with two parents is
// accepted; readers show it at both places, and here it lies where the first of them puts it.
// Animations, and the extension that gives a node many instances, move nothing here.
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <optional>

#include "core/asset/gltf/elements.hpp"
#include "core/asset/reader/steps.hpp"

namespace unwrapd::asset::reader {
namespace {

constexpr double kLeastArea = 1e-24, kGreatestArea = 1e24;  ///< of a placement, times the mesh's
constexpr double kFarthest = 1e30;                          ///< from the origin, see is_visible()

/// The children of all nodes, one after another: those of node i begin at first[i].
struct Children {
  std::vector<std::size_t> node;
  std::vector<std::size_t> first = {0};
  std::vector<std::size_t> parent_counts;  ///< one a node

  template <class Visit>
  void for_each(std::size_t parent, Visit visit) const {
    for (std::size_t c = first[parent]; c < first[parent + 1]; ++c) visit(node[c]);
  }
};

Children checked_children(const Gltf& gltf) {
  const std::size_t count = list_size(gltf, "nodes");
  const std::size_t mesh_count = list_size(gltf, "meshes");
  Children children;
  children.parent_counts.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Node node = Node(gltf.json).at("nodes").at(i);
    if (const auto mesh = node.find("mesh")) static_cast<void>(mesh->index(mesh_count, "meshes"));
    const auto list = node.find("children");
    const std::size_t child_count = list ? list->array_size() : 0;
    for (std::size_t k = 0; k < child_count; ++k) {
      children.node.push_back(list->at(k).index(count, "nodes"));
      ++children.parent_counts[children.node.back()];
    }
    children.first.push_back(children.node.size());
  }
  return children;
}

/// All nodes, parents before their children (Kahn 1962). Linear however many parents a node has.
std::vector<std::size_t> parents_first(const Children& children) {
  std::vector<std::size_t> waits_for = children.parent_counts, order;
  for (std::size_t i = 0; i < waits_for.size(); ++i)
    if (waits_for[i] == 0) order.push_back(i);
  for (std::size_t k = 0; k < order.size(); ++k)
    children.for_each(order[k], [&](std::size_t child) {
      if (--waits_for[child] == 0) order.push_back(child);
    });
  if (order.size() == waits_for.size()) return order;
  const auto in_cycle = std::ranges::find_if(waits_for, [](std::size_t n) { return n > 0; });
  fail(ErrorCode::malformed_gltf,
       Place().at("nodes").at(static_cast<std::size_t>(in_cycle - waits_for.begin())),
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

/// The numbers of a member, or what they are without it. The asset comes back with the member as it
/// is, so that a wrong one is no reason to refuse it; nor is a wrong number of a skin or a scene.
template <std::size_t N>
std::array<double, N> numbers(const Json& node, const char* name, std::array<double, N> otherwise) {
  const auto member = node.find(name);
  if (member == node.end() || !member->is_array() || member->size() != N) return otherwise;
  std::array<double, N> read;
  for (std::size_t k = 0; k < N; ++k) {
    if (!member->at(k).is_number()) return otherwise;
    read[k] = member->at(k).get<double>();
  }
  return read;
}

/// The number of a list's entry, if a value is one.
std::optional<std::size_t> index_in(const Json& value, std::size_t size) {
  if (!value.is_number_unsigned() || value.get<std::size_t>() >= size) return std::nullopt;
  return value.get<std::size_t>();
}

/// The same of a member, which may be absent.
std::optional<std::size_t> index_in(const Json& object, const char* name, std::size_t size) {
  const auto member = object.find(name);
  return member == object.end() ? std::nullopt : index_in(*member, size);
}

/// A matrix by columns (glTF 2.0, Sec. 3.5.2).
Placement from_columns(const std::array<double, 16>& m) {
  Placement placement;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      placement.linear(row, column) = m[static_cast<std::size_t>(4 * column + row)];
  placement.origin = {m[12], m[13], m[14]};
  return placement;
}

Placement local_placement(const Json& node) {
  if (node.contains("matrix"))
    return from_columns(
        numbers<16>(node, "matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
  const auto [x, y, z, w] = numbers<4>(node, "rotation", {0, 0, 0, 1});
  const auto scale = numbers<3>(node, "scale", {1, 1, 1});
  const auto move = numbers<3>(node, "translation", {0, 0, 0});
  Eigen::Quaterniond turn(w, x, y, z);
  if (turn.norm() > 0)
    turn.normalize();
  else
    turn.setIdentity();
  Placement placement;
  placement.linear = turn.toRotationMatrix() * Vec3(scale[0], scale[1], scale[2]).asDiagonal();
  placement.origin = {move[0], move[1], move[2]};
  return placement;
}

/// The inverse bind matrix of a skin's first joint.
Placement inverse_bind(const Gltf& gltf, const Json& skin) {
  const auto accessor = index_in(skin, "inverseBindMatrices", gltf.accessors.size());
  if (!accessor || gltf.accessors[*accessor].components != 16 ||
      gltf.accessors[*accessor].count == 0)
    return {};
  const Elements matrices(gltf, *accessor);
  std::array<double, 16> m;
  for (std::size_t k = 0; k < m.size(); ++k) m[k] = matrices.component_of(0, k);
  return from_columns(m);
}

/// A skinned mesh lies where its joints put it, and not where its node is (Sec. 3.7.3.3): here,
/// where the first joint does.
std::optional<Placement> placement_by_skin(const Gltf& gltf, const Json& node,
                                           const std::vector<Placement>& world) {
  const auto skins = gltf.json.find("skins");
  if (skins == gltf.json.end() || !skins->is_array()) return std::nullopt;
  const auto number = index_in(node, "skin", skins->size());
  if (!number) return std::nullopt;
  const Json& skin = skins->at(*number);
  const auto joints = skin.find("joints");
  if (joints == skin.end() || !joints->is_array() || joints->empty()) return std::nullopt;
  const auto first = index_in(joints->front(), world.size());
  if (!first) return std::nullopt;
  return world[*first] * inverse_bind(gltf, skin);
}

/// The place of every node in the space of its scene.
std::vector<Placement> world_placements(const Json& nodes, const Children& children,
                                        const std::vector<std::size_t>& order) {
  std::vector<Placement> world(order.size());
  std::vector<char> has_parent(order.size());
  for (const std::size_t i : order) {
    const Placement own = local_placement(nodes.at(i));
    world[i] = has_parent[i] != 0 ? world[i] * own : own;
    children.for_each(i, [&](std::size_t child) {
      if (has_parent[child] == 0) world[child] = world[i];
      has_parent[child] = 1;
    });
  }
  return world;
}

/// One a node: whether the scene that viewers show has it.
std::vector<char> in_default_scene(const Gltf& gltf, const Children& children,
                                   const std::vector<std::size_t>& order) {
  std::vector<char> is_in(order.size());
  const std::size_t count = list_size(gltf, "scenes");
  if (count == 0) return is_in;
  const std::size_t scene = index_in(gltf.json, "scene", count).value_or(0);
  const auto roots = Node(gltf.json).at("scenes").at(scene).find("nodes");
  for (std::size_t k = 0; roots && k < roots->array_size(); ++k) is_in[roots->at(k).number()] = 1;
  for (const std::size_t i : order)
    if (is_in[i] != 0) children.for_each(i, [&](std::size_t child) { is_in[child] = 1; });
  return is_in;
}

/// Whether a mesh has area in this place, and fits into floats. Else its node hides it, or is
/// wrong.
bool is_visible(const Placement& placement) {
  const double area = placement.cofactors().norm();  // times that of the mesh
  return area >= kLeastArea && area <= kGreatestArea && placement.origin.allFinite() &&
         placement.origin.cwiseAbs().maxCoeff() <= kFarthest;
}

std::vector<MeshNode> mesh_nodes(const Gltf& gltf, const std::vector<Placement>& world,
                                 const std::vector<char>& is_shown) {
  std::vector<MeshNode> shown;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const Json& node = gltf.json.at("nodes").at(i);
    const auto mesh = node.find("mesh");
    if (mesh == node.end() || is_shown[i] == 0) continue;
    const Placement placement = placement_by_skin(gltf, node, world).value_or(world[i]);
    if (is_visible(placement)) shown.push_back({mesh->get<std::size_t>(), placement});
  }
  return shown;
}

}  // namespace

void read_nodes(Gltf& gltf) {
  const Children children = checked_children(gltf);
  const std::vector<std::size_t> order = parents_first(children);
  check_scenes(gltf, order.size());
  const auto shared = std::ranges::count_if(children.parent_counts,
                                            [](std::size_t parents) { return parents > 1; });
  if (shared > 0) gltf.repairs.push_back({FileRepairKind::shared_nodes_kept, shared});
  if (order.empty()) return;
  const std::vector<Placement> world = world_placements(gltf.json.at("nodes"), children, order);
  gltf.mesh_nodes = mesh_nodes(gltf, world, in_default_scene(gltf, children, order));
  if (gltf.mesh_nodes.empty())
    gltf.mesh_nodes = mesh_nodes(gltf, world, std::vector<char>(order.size(), 1));
}

}  // namespace unwrapd::asset::reader
