// Draco primitives become plain ones: what a bitstream holds is written into the accessors that the
// primitive names. An accessor that already has data (a fallback for readers without Draco, or the
// result of another bitstream) is left as it is, and the primitive gets one of its own.
#include <map>
#include <set>
#include <tuple>

#include "core/asset/draco.hpp"
#include "core/asset/gltf_steps.hpp"
#include "core/asset/grow.hpp"
#include "core/cancel.hpp"

namespace unwrapd::asset {
namespace {

constexpr const char* kExtension = "KHR_draco_mesh_compression";

class Unpacker {
 public:
  Unpacker(const Gltf& gltf, const ReadLimits& limits)
      : gltf_(gltf),
        left_(limits),
        patched_{gltf.json, {}},
        views_(patched_, gltf.buffers.size()) {}

  void unpack(const DracoSource& source) {
    const Key key = key_of(source);
    auto found = done_.find(key);
    if (found == done_.end()) found = done_.emplace(key, decode(source)).first;
    Json& primitive = json_of(source);
    for (const auto& [semantic, accessor] : found->second.attributes)
      primitive["attributes"][semantic] = accessor;
    primitive["indices"] = found->second.indices;
    primitive.erase("mode");  // Draco's faces are a list of triangles, which is the default
    remove_extension(primitive, kExtension);
  }

  PatchedDocument finish() {
    forget_extension(patched_.json, kExtension);
    return std::move(patched_);
  }

 private:
  using Named = std::vector<std::pair<std::string, std::size_t>>;
  /// Primitives that agree in these get the same accessors.
  using Key = std::tuple<std::size_t, Named, Named, std::optional<std::size_t>>;

  struct Unpacked {
    Named attributes;
    std::size_t indices = 0;
  };

  [[nodiscard]] Key key_of(const DracoSource& source) const {
    const Primitive& primitive = gltf_.primitives[source.primitive];
    return {source.view, source.attributes, primitive.attributes, primitive.indices};
  }

  [[nodiscard]] Place place_of(const DracoSource& source) const {
    return primitive_place(gltf_.primitives[source.primitive]).at("extensions").at(kExtension);
  }

  Json& json_of(const DracoSource& source) {
    const Primitive& p = gltf_.primitives[source.primitive];
    return patched_.json["meshes"][p.mesh]["primitives"][p.number];
  }

  [[nodiscard]] std::string_view bitstream(const DracoSource& source) const {
    const View& view = gltf_.views[source.view];
    return std::string_view(gltf_.buffers[view.buffer]).substr(view.offset, view.length);
  }

  Unpacked decode(const DracoSource& source) {
    throw_if_cancelled(gltf_.stop);
    const DracoMesh mesh(bitstream(source), left_, place_of(source));
    throw_if_cancelled(gltf_.stop);
    const std::vector<Index> corners = mesh.corners();
    left_.max_vertices -= static_cast<std::int64_t>(mesh.point_count());
    left_.max_faces -= static_cast<std::int64_t>(corners.size() / 3);
    if (corners.empty())
      fail(ErrorCode::malformed_draco, place_of(source),
           "the Draco data has no faces; compress the asset again");
    Unpacked unpacked;
    for (const auto& [semantic, id] : source.attributes)
      unpacked.attributes.emplace_back(semantic, add_attribute(source, semantic, id, mesh));
    unpacked.indices = add_indices(gltf_.primitives[source.primitive].indices, corners);
    return unpacked;
  }

  /// The accessor that the primitive has for what the bitstream calls `semantic`.
  std::size_t accessor_of(const DracoSource& source, const std::string& semantic) const {
    for (const auto& [name, accessor] : gltf_.primitives[source.primitive].attributes)
      if (name == semantic) return accessor;
    fail(ErrorCode::malformed_draco, place_of(source).at("attributes"),
         "the primitive itself has no attribute " + semantic + "; compress the asset again");
  }

  std::size_t add_attribute(const DracoSource& source, const std::string& semantic, std::size_t id,
                            const DracoMesh& mesh) {
    throw_if_cancelled(gltf_.stop);
    const std::size_t old = accessor_of(source, semantic);
    const Accessor& accessor = gltf_.accessors[old];
    const std::string bytes = mesh.elements(id, accessor);
    const std::size_t stride = bytes.size() / mesh.point_count();
    Json json = patched_.json["accessors"][old];
    json["bufferView"] =
        views_.add(bytes, stride == accessor.element_bytes ? 0 : stride, kArrayBufferTarget);
    json["count"] = mesh.point_count();
    for (const char* stale : {"byteOffset", "sparse"}) json.erase(stale);
    if (json.contains("min") || json.contains("max"))
      set_bounds(json, bytes, stride, accessor.components);
    return put(old, std::move(json));
  }

  std::size_t add_indices(std::optional<std::size_t> old, const std::vector<Index>& corners) {
    Json json = index_accessor(gltf_, old, corners, views_);
    return old ? put(*old, std::move(json)) : append(std::move(json));
  }

  std::size_t put(std::size_t old, Json accessor) {
    if (gltf_.accessors[old].view || !filled_.insert(old).second)
      return append(std::move(accessor));
    patched_.json["accessors"][old] = std::move(accessor);
    return old;
  }

  std::size_t append(Json accessor) {
    Json& accessors = patched_.json["accessors"];
    accessors.push_back(std::move(accessor));
    return accessors.size() - 1;
  }

  const Gltf& gltf_;
  ReadLimits left_;  ///< what all bitstreams together may still hold
  PatchedDocument patched_;
  NewViews views_;
  std::map<Key, Unpacked> done_;
  std::set<std::size_t> filled_;
};

}  // namespace

void decode_draco(Gltf& gltf, const std::vector<DracoSource>& sources, const ReadLimits& limits) {
  Unpacker unpacker(gltf, limits);
  for (const DracoSource& source : sources) unpacker.unpack(source);
  PatchedDocument unpacked = unpacker.finish();
  gltf.json = std::move(unpacked.json);
  for (const DracoSource& source : sources) gltf.spent_views.push_back(source.view);
  add_buffer(gltf, std::move(unpacked.added));
}

}  // namespace unwrapd::asset
