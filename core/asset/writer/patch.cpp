// Patches the pools of a document one by one: vertices get copies at the cut, faces get new
// indices, and all of them get their texture coordinates. An accessor that nothing else uses is
// changed in place, so that the numbers in the document stay valid.
#include "core/asset/writer/patch.hpp"

#include <algorithm>
#include <map>

#include "core/asset/gltf/images.hpp"
#include "core/asset/gltf/materials.hpp"
#include "core/asset/gltf/new_accessors.hpp"
#include "core/asset/gltf/references.hpp"
#include "core/asset/writer/cut.hpp"
#include "core/asset/writer/transfer_textures.hpp"

namespace unwrapd::asset::writer {
namespace {

class Patcher {
 public:
  explicit Patcher(const Gltf& gltf)
      : gltf_(gltf),
        materials_(gltf),
        patched_{gltf.json, {}, &gltf.aside},
        views_(patched_, gltf.buffers.size()),
        references_(count_accessor_references(gltf.json, gltf.accessors.size())) {}

  void patch_pool(const Pool& pool, const Cut& cut) {
    const Split& split = cut.split;
    if (!split.copies.empty()) grow_attributes(pool, split);
    for (const auto& [piece, users] : users_of(pool, split))
      set_indices(users, split.corners.at(piece));
    set_texcoords(pool, split);
    if (!cut.tangents.empty()) set_tangents(pool, cut.tangents);
  }

  void take_textures(std::span<const UnwrappedSurface> unwrapped, const WrittenTangents& tangents) {
    transfer_textures(gltf_, unwrapped, tangents, patched_.json, views_);
  }

  void take_images() { embed_images(gltf_, patched_.json, views_); }

  PatchedDocument finish() {
    if (!gltf_.transfer) reset_materials();
    return std::move(patched_);
  }

 private:
  using Uses = std::map<std::size_t, std::size_t>;  // accessor, how often

  Json& json_of(std::size_t primitive) {
    return asset::json_of(patched_.json, gltf_.primitives[primitive]);
  }

  /// Unwrapped primitives get copies of materials that others have, too.
  void reset_materials() {
    const MaterialsToReset to_reset = materials_.to_reset();
    Pace pace(gltf_.stop);
    for (const std::size_t material : to_reset.in_place)
      reset_transforms(patched_.json["materials"][material], gltf_.texcoord, pace);
    std::map<std::size_t, std::size_t> copies;
    for (const std::size_t material : to_reset.copied) {
      Json copy = patched_.json["materials"][material];
      reset_transforms(copy, gltf_.texcoord, pace);
      copies[material] = patched_.json["materials"].size();
      patched_.json["materials"].push_back(std::move(copy));
    }
    for (std::size_t i = 0; !copies.empty() && i < gltf_.primitives.size(); ++i)
      if (gltf_.primitives[i].has_triangles)
        for_each_material(json_of(i), [&](Json& number) {
          const auto copy = copies.find(number.get<std::size_t>());
          if (copy != copies.end()) number = copy->second;
        });
  }

  /// Takes an attribute out of a primitive's morph targets. A target with nothing else keeps zeros,
  /// since glTF allows no empty one.
  void drop_from_targets(std::size_t primitive, const std::string& semantic, const char* type,
                         std::size_t vertices) {
    const auto targets = json_of(primitive).find("targets");
    if (targets == json_of(primitive).end()) return;
    for (Json& target : *targets) {
      if (target.size() > 1)
        target.erase(semantic);
      else if (target.contains(semantic))
        target[semantic] =
            add_accessor({{"componentType", 5126}, {"count", vertices}, {"type", type}});
    }
  }

  /// Replaces the old accessor if `uses` are all its references, else appends the new one.
  std::size_t put_accessor(std::size_t old, std::size_t uses, Json accessor) {
    Json& accessors = patched_.json["accessors"];
    if (references_[old] == uses && !gltf_.has_foreign_references) {
      accessors[old] = std::move(accessor);
      return old;
    }
    accessors.push_back(std::move(accessor));
    return accessors.size() - 1;
  }

  std::size_t add_accessor(Json accessor) {
    Json& accessors = patched_.json["accessors"];
    accessors.push_back(std::move(accessor));
    return accessors.size() - 1;
  }

  /// Whether an attribute is copied, not replaced.
  [[nodiscard]] bool is_kept(const Primitive& primitive, const std::string& semantic) const {
    return semantic != gltf_.texcoord &&
           !(semantic == "TANGENT" && materials_.loses_tangents(primitive));
  }

  Uses vertex_uses(const Pool& pool) const {
    Uses uses;
    for (const std::size_t i : pool.primitives) {
      const Primitive& primitive = gltf_.primitives[i];
      for (const auto& [semantic, accessor] : primitive.attributes)
        if (is_kept(primitive, semantic)) ++uses[accessor];
      for (const std::size_t accessor : primitive.targets) ++uses[accessor];
    }
    return uses;
  }

  void grow_attributes(const Pool& pool, const Split& split) {
    std::map<std::size_t, std::size_t> moved;
    for (const auto& [accessor, uses] : vertex_uses(pool)) {
      const std::size_t now =
          put_accessor(accessor, uses, grown_accessor(gltf_, accessor, split.copies, views_));
      if (now != accessor) moved[accessor] = now;
    }
    if (moved.empty()) return;
    for (const std::size_t i : pool.primitives) follow(json_of(i), moved);
  }

  static void follow(Json& primitive, const std::map<std::size_t, std::size_t>& moved) {
    const auto update = [&](Json& named) {
      for (auto& [semantic, accessor] : named.items())
        if (const auto found = moved.find(accessor.get<std::size_t>()); found != moved.end())
          accessor = found->second;
    };
    update(primitive["attributes"]);
    if (primitive.contains("targets"))
      std::for_each(primitive["targets"].begin(), primitive["targets"].end(), update);
  }

  /// The pool's primitives by their piece, for pieces whose faces have changed.
  std::map<std::size_t, std::vector<std::size_t>> users_of(const Pool& pool,
                                                           const Split& split) const {
    std::map<std::size_t, std::vector<std::size_t>> users;
    for (const std::size_t i : pool.primitives)
      if (split.changed.contains(gltf_.primitives[i].piece))
        users[gltf_.primitives[i].piece].push_back(i);
    return users;
  }

  void set_indices(const std::vector<std::size_t>& users, const std::vector<Index>& corners) {
    const std::optional<std::size_t> old = gltf_.primitives[users.front()].indices;
    Json accessor = index_accessor(gltf_, old, corners, views_);
    const std::size_t now = old ? put_accessor(*old, users.size(), std::move(accessor))
                                : add_accessor(std::move(accessor));
    for (const std::size_t i : users) {
      json_of(i)["indices"] = now;
      if (gltf_.primitives[i].mode != Mode::triangles) json_of(i)["mode"] = Mode::triangles;
    }
  }

  /// How often the pool uses each accessor as the replaced texture coordinates.
  Uses texcoord_uses(const Pool& pool) const {
    Uses uses;
    for (const std::size_t i : pool.primitives)
      for (const auto& [semantic, accessor] : gltf_.primitives[i].attributes)
        if (semantic == gltf_.texcoord) ++uses[accessor];
    return uses;
  }

  void set_texcoords(const Pool& pool, const Split& split) {
    const Uses uses = texcoord_uses(pool);
    const std::optional<std::size_t> old =
        uses.empty() ? std::nullopt : std::optional(uses.begin()->first);
    Json accessor = texcoord_accessor(gltf_, old, split.uv, views_);
    const std::size_t now = old ? put_accessor(*old, uses.begin()->second, std::move(accessor))
                                : add_accessor(std::move(accessor));
    for (const std::size_t i : pool.primitives) {
      Json& attributes = json_of(i)["attributes"];
      attributes[gltf_.texcoord] = now;
      for (const std::string& set : missing_sets(gltf_, gltf_.primitives[i])) attributes[set] = now;
      drop_from_targets(i, gltf_.texcoord, "VEC2", split.uv.size());
    }
  }

  /// The accessor of a primitive's tangents, if they belong to the replaced coordinates.
  [[nodiscard]] std::optional<std::size_t> stale_tangents(std::size_t primitive) const {
    const Primitive& p = gltf_.primitives[primitive];
    if (!materials_.loses_tangents(p)) return std::nullopt;
    for (const auto& [semantic, accessor] : p.attributes)
      if (semantic == "TANGENT") return accessor;
    return std::nullopt;
  }

  void set_tangents(const Pool& pool, const std::vector<Tangent>& tangents) {
    std::vector<std::size_t> users;
    for (const std::size_t i : pool.primitives)
      if (stale_tangents(i)) users.push_back(i);
    const std::size_t old = *stale_tangents(users.front());
    const auto is_old = [&](std::size_t i) { return stale_tangents(i) == old; };
    const auto uses = static_cast<std::size_t>(std::count_if(users.begin(), users.end(), is_old));
    const std::size_t now = put_accessor(old, uses, tangent_accessor(gltf_, old, tangents, views_));
    for (const std::size_t i : users) {
      json_of(i)["attributes"]["TANGENT"] = now;
      drop_from_targets(i, "TANGENT", "VEC3", tangents.size());
    }
  }

  const Gltf& gltf_;
  Materials materials_;
  PatchedDocument patched_;
  NewViews views_;
  std::vector<std::size_t> references_;
};

}  // namespace

std::vector<VertexMap> vertex_maps_of_patch(const Gltf& gltf,
                                            std::span<const UnwrappedSurface> unwrapped) {
  std::vector<VertexMap> maps;
  Cutter cutter(gltf, unwrapped);
  for (const Pool& pool : pools_of(gltf)) {
    const std::size_t count =
        gltf.accessors[gltf.primitives[pool.primitives.front()].position].count;
    const Cut cut = cutter.cut(pool);
    for (const std::size_t i : pool.primitives)
      maps.push_back({primitive_place(gltf.primitives[i]).pointer(),
                      static_cast<std::int64_t>(count), cut.split.copies});
  }
  return maps;
}

PatchedDocument patch(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped,
                      Format output) {
  Patcher patcher(gltf);
  Cutter cutter(gltf, unwrapped);
  WrittenTangents tangents;
  for (const Pool& pool : pools_of(gltf)) {
    const Cut cut = cutter.cut(pool);
    patcher.patch_pool(pool, cut);
    if (gltf.transfer) add_tangents(cut, tangents);
  }
  if (gltf.transfer) patcher.take_textures(unwrapped, tangents);
  if (gltf.came_as_text && output == Format::glb) patcher.take_images();
  return patcher.finish();
}

}  // namespace unwrapd::asset::writer
