// The pools of a document, one by one: where the cut asks for it their vertices grow by copies,
// their faces are indexed anew, and all of them get their texture coordinates. An accessor that
// nothing else uses is changed in place, so that the numbers in the document stay what they were.
#include "core/asset/patch.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "core/asset/grow.hpp"
#include "core/asset/materials.hpp"
#include "core/asset/references.hpp"
#include "core/asset/split.hpp"

namespace unwrapd::asset {
namespace {

/// The primitives that share a pool's vertices, and which pieces are theirs, in order of first use.
struct Pool {
  std::vector<std::size_t> primitives;
  std::vector<std::size_t> pieces;
};

/// The lower sets of texture coordinates that the primitive lacks: a document must not skip any.
std::vector<std::string> missing_sets(const Gltf& gltf, const Primitive& primitive) {
  std::vector<std::string> missing;
  for (int n = 0; n <= kMaxTexcoord; ++n) {
    const std::string set = "TEXCOORD_" + std::to_string(n);
    if (set == gltf.texcoord) break;
    const auto is_set = [&](const auto& item) { return item.first == set; };
    if (std::none_of(primitive.attributes.begin(), primitive.attributes.end(), is_set))
      missing.push_back(set);
  }
  return missing;
}

std::vector<Pool> pools_of(const Gltf& gltf) {
  std::vector<Pool> pools(gltf.pool_count);
  std::set<std::pair<std::size_t, std::size_t>> seen;
  for (std::size_t i = 0; i < gltf.primitives.size(); ++i) {
    const Primitive& primitive = gltf.primitives[i];
    if (!primitive.has_triangles) continue;
    Pool& pool = pools[primitive.pool];
    pool.primitives.push_back(i);
    if (seen.emplace(primitive.pool, primitive.piece).second)
      pool.pieces.push_back(primitive.piece);
  }
  return pools;
}

class Patcher {
 public:
  explicit Patcher(const Gltf& gltf)
      : gltf_(gltf),
        patched_{gltf.json, {}},
        views_(patched_, gltf.buffers.size()),
        references_(count_accessor_references(gltf.json, gltf.accessors.size())) {}

  void patch_pool(const Pool& pool, const Split& split) {
    drop_tangents(pool);
    if (!split.copies.empty()) grow_attributes(pool, split);
    for (const auto& [piece, users] : users_of(pool, split))
      set_indices(users, split.corners.at(piece));
    set_texcoords(pool, split);
  }

  PatchedDocument finish() {
    for (const std::size_t material : materials_to_reset(gltf_))
      reset_transforms(patched_.json["materials"][material], gltf_.texcoord);
    return std::move(patched_);
  }

 private:
  using Uses = std::map<std::size_t, std::size_t>;  // accessor, how often

  Json& json_of(std::size_t primitive) {
    const Primitive& p = gltf_.primitives[primitive];
    return patched_.json["meshes"][p.mesh]["primitives"][p.number];
  }

  /// Puts the accessor in the old one's place if `uses` are all that refer to it, else at the end.
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

  /// Whether an attribute is carried over: neither replaced nor dropped.
  [[nodiscard]] bool is_kept(const Primitive& primitive, const std::string& semantic) const {
    return semantic != gltf_.texcoord &&
           !(semantic == "TANGENT" && loses_tangents(gltf_, primitive));
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

  /// The pool's primitives by the piece that they show, as far as its faces have changed.
  std::map<std::size_t, std::vector<std::size_t>> users_of(const Pool& pool,
                                                           const Split& split) const {
    std::map<std::size_t, std::vector<std::size_t>> users;
    for (const std::size_t i : pool.primitives)
      if (split.corners.contains(gltf_.primitives[i].piece))
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

  /// How often the pool uses each accessor as the texture coordinates that are replaced.
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
    }
  }

  void drop_tangents(const Pool& pool) {
    for (const std::size_t i : pool.primitives) {
      if (!loses_tangents(gltf_, gltf_.primitives[i])) continue;
      json_of(i)["attributes"].erase("TANGENT");
      if (!json_of(i).contains("targets")) continue;
      for (Json& target : json_of(i)["targets"]) target.erase("TANGENT");
    }
  }

  const Gltf& gltf_;
  PatchedDocument patched_;
  NewViews views_;
  std::vector<std::size_t> references_;
};

std::string counted(std::size_t count, const char* thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

}  // namespace

std::vector<std::string> side_effects_of_patch(const Gltf& gltf) {
  std::size_t without_tangents = 0, with_lower_sets = 0;
  for (const Primitive& primitive : gltf.primitives) {
    if (!primitive.has_triangles) continue;
    without_tangents += loses_tangents(gltf, primitive) ? 1 : 0;
    with_lower_sets += missing_sets(gltf, primitive).empty() ? 0 : 1;
  }
  const std::size_t reset = materials_to_reset(gltf).size();
  std::vector<std::string> notes;
  if (without_tangents > 0)
    notes.push_back("The tangents of " + counted(without_tangents, "primitive") +
                    " belonged to the replaced texture coordinates and are left out; readers make "
                    "new ones.");
  if (reset > 0)
    notes.push_back("The KHR_texture_transform of " + counted(reset, "material") +
                    " is reset for " + gltf.texcoord +
                    ", whose new coordinates lie on the page as they are.");
  if (with_lower_sets > 0)
    notes.push_back(counted(with_lower_sets, "primitive") + " lacked texture coordinates below " +
                    gltf.texcoord + "; glTF allows no gap, so these sets are the same.");
  return notes;
}

std::vector<VertexMap> vertex_maps_of_patch(const Gltf& gltf,
                                            std::span<const UnwrappedSurface> unwrapped) {
  std::vector<VertexMap> maps;
  Splitter splitter(gltf, unwrapped);
  for (const Pool& pool : pools_of(gltf)) {
    if (pool.primitives.empty()) continue;
    const std::size_t count =
        gltf.accessors[gltf.primitives[pool.primitives.front()].position].count;
    const Split split = splitter.split(pool.pieces, count);
    for (const std::size_t i : pool.primitives)
      maps.push_back({primitive_place(gltf.primitives[i]).pointer(),
                      static_cast<std::int64_t>(count), split.copies});
  }
  return maps;
}

PatchedDocument patch(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped) {
  Patcher patcher(gltf);
  Splitter splitter(gltf, unwrapped);
  for (const Pool& pool : pools_of(gltf)) {
    if (pool.primitives.empty()) continue;
    const Primitive& first = gltf.primitives[pool.primitives.front()];
    patcher.patch_pool(pool, splitter.split(pool.pieces, gltf.accessors[first.position].count));
  }
  return patcher.finish();
}

}  // namespace unwrapd::asset
