// Selects the primitives to unwrap. The others do not change: they are in no surface, and data that
// they share with a selected one is copied.
#include <algorithm>
#include <unordered_map>

#include "core/asset/reader/steps.hpp"

namespace unwrapd::asset::reader {
namespace {

[[noreturn]] void refuse(std::string_view list, std::size_t i, const std::string& message) {
  throw Error(ErrorCode::invalid_option, message, Place().at(list).at(i).pointer());
}

using PrimitivesByName = std::unordered_map<std::string, std::vector<std::size_t>>;

/// The primitives that have a material of this name. Each name is read once, however long it is and
/// however many primitives have it.
PrimitivesByName by_material(const Gltf& gltf) {
  const auto list = gltf.json.find("materials");
  if (list == gltf.json.end()) return {};
  std::vector<std::vector<std::size_t>> users(list->size());
  for (std::size_t i = 0; i < gltf.primitives.size(); ++i)
    if (gltf.primitives[i].material) users[*gltf.primitives[i].material].push_back(i);
  PrimitivesByName names;
  for (std::size_t m = 0; m < users.size(); ++m) {
    if (users[m].empty()) continue;
    const Json& material = list->at(m);
    const auto name = material.find("name");
    const bool is_named = name != material.end() && name->is_string();
    std::vector<std::size_t>& all = names[is_named ? name->get<std::string>() : std::string()];
    all.insert(all.end(), users[m].begin(), users[m].end());
  }
  return names;
}

PrimitivesByName by_pointer(const Gltf& gltf) {
  PrimitivesByName names;
  for (std::size_t i = 0; i < gltf.primitives.size(); ++i)
    names[primitive_place(gltf.primitives[i]).pointer()].push_back(i);
  return names;
}

/// "A, B": what may be named, where that is short.
std::string listed(const PrimitivesByName& names) {
  constexpr std::size_t kMostNames = 12, kMostCharacters = 60;
  std::vector<std::string> all;
  for (const auto& [name, primitives] : names)
    if (!name.empty() && name.size() <= kMostCharacters) all.push_back(name);
  std::ranges::sort(all);
  std::string text;
  for (std::size_t k = 0; k < std::min(all.size(), kMostNames); ++k)
    text += (k == 0 ? "" : ", ") + all[k];
  if (text.empty()) return "names of materials of the asset";
  return all.size() > kMostNames ? text + " or another" : text;
}

/// Marks the primitives of these names. A name is then removed from the map, so that repeating it
/// marks nothing.
void mark(std::string_view option, const std::vector<std::string>& wanted, PrimitivesByName names,
          std::vector<char>& marked) {
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const auto found = names.find(wanted[k]);
    if (found == names.end())
      refuse(option, k,
             option == "materials"
                 ? "no primitive has a material of this name; give " + listed(names)
                 : "the asset has no such primitive; point to one, as in /meshes/0/primitives/1");
    for (const std::size_t i : found->second) marked[i] = 1;
    found->second.clear();
  }
}

}  // namespace

void select_primitives(Gltf& gltf, const AssetOptions& options) {
  if (options.materials.empty() && options.primitives.empty()) return;
  std::vector<char> marked(gltf.primitives.size(), 0);
  if (!options.materials.empty()) mark("materials", options.materials, by_material(gltf), marked);
  if (!options.primitives.empty()) mark("primitives", options.primitives, by_pointer(gltf), marked);
  for (std::size_t i = 0; i < marked.size(); ++i)
    gltf.primitives[i].has_triangles = gltf.primitives[i].has_triangles && marked[i] != 0;
}

}  // namespace unwrapd::asset::reader
