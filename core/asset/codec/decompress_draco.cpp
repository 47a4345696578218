// Draco primitives become plain ones: the contents of a bitstream are written to the accessors that
// the primitive names. An accessor that already has data (a fallback for readers without Draco, or
// the result of another bitstream) stays as it is, and the primitive gets a new one.
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>

#include "core/asset/codec/decompress.hpp"
#include "core/asset/codec/draco.hpp"
#include "core/asset/gltf/extensions.hpp"
#include "core/asset/gltf/new_accessors.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::codec {
namespace {

constexpr const char* kExtension = "KHR_draco_mesh_compression";

/// The primitives that share a bitstream.
using Sharers = std::vector<const DracoSource*>;

/// The parts of a bitstream that were written to the document. Each part is written once, for all
/// accessors that name it.
class Unpacked {
 public:
  Unpacked(const Gltf& gltf, const DracoMesh& mesh, NewViews& views)
      : gltf_(gltf), mesh_(mesh), views_(views), corners_(mesh.corners()) {}

  [[nodiscard]] std::size_t face_count() const { return corners_.size() / 3; }

  /// The accessor with its elements from the bitstream's attribute `id`.
  Json attribute(const Accessor& accessor, Json json, std::size_t id) {
    const Written& elements = written(accessor, id);
    json["bufferView"] = elements.view;
    json["count"] = mesh_.point_count();
    for (const char* stale : {"byteOffset", "sparse"}) json.erase(stale);
    if (json.contains("min") || json.contains("max"))
      for (const char* bound : {"min", "max"}) json[bound] = elements.bounds.at(bound);
    return json;
  }

  Json indices(std::optional<std::size_t> old) {
    const bool had_u8 = old && gltf_.accessors[*old].type == ComponentType::u8;
    const auto found = indices_.find(had_u8);
    if (found != indices_.end()) return accessor_like(gltf_, old, found->second);
    return indices_.emplace(had_u8, index_accessor(gltf_, old, corners_, views_)).first->second;
  }

 private:
  struct Written {
    std::size_t view = 0;
    Json bounds;  ///< min and max
  };

  const Written& written(const Accessor& accessor, std::size_t id) {
    const auto [found, is_new] =
        elements_.try_emplace({id, accessor.type, accessor.components, accessor.element_bytes});
    if (!is_new) return found->second;
    throw_if_cancelled(gltf_.stop);
    const std::string bytes = mesh_.elements(id, accessor);
    const std::size_t stride = bytes.size() / mesh_.point_count();
    found->second.bounds = {{"componentType", accessor.type}};
    set_bounds(found->second.bounds, bytes, stride, accessor.components);
    found->second.view =
        views_.add(bytes, stride == accessor.element_bytes ? 0 : stride, kArrayBufferTarget);
    return found->second;
  }

  const Gltf& gltf_;
  const DracoMesh& mesh_;
  NewViews& views_;
  std::vector<Index> corners_;
  std::map<std::tuple<std::size_t, ComponentType, std::size_t, std::size_t>, Written> elements_;
  std::map<bool, Json> indices_;  ///< [may be bytes]
};

class Unpacker {
 public:
  Unpacker(const Gltf& gltf, const ReadLimits& limits)
      : gltf_(gltf),
        left_(limits),
        patched_{gltf.json, {}},
        views_(patched_, gltf.buffers.size()) {}

  void unpack(const Sharers& sharers) {
    throw_if_cancelled(gltf_.stop);
    const Place place = place_of(*sharers.front());
    const DracoMesh mesh(bitstream(*sharers.front()), left_, place);
    throw_if_cancelled(gltf_.stop);
    Unpacked unpacked(gltf_, mesh, views_);
    if (unpacked.face_count() == 0)
      fail(ErrorCode::malformed_draco, place,
           "the Draco data has no faces; compress the asset again");
    left_.max_vertices -= static_cast<std::int64_t>(mesh.point_count());
    left_.max_faces -= static_cast<std::int64_t>(unpacked.face_count());
    attributes_.clear();
    indices_.clear();
    for (const DracoSource* source : sharers) unpack_primitive(*source, unpacked);
  }

  PatchedDocument finish() {
    forget_extension(patched_.json, kExtension);
    return std::move(patched_);
  }

 private:
  [[nodiscard]] const Primitive& primitive_of(const DracoSource& source) const {
    return gltf_.primitives[source.primitive];
  }

  [[nodiscard]] Place place_of(const DracoSource& source) const {
    return primitive_place(primitive_of(source)).at("extensions").at(kExtension);
  }

  [[nodiscard]] std::string_view bitstream(const DracoSource& source) const {
    const View& view = gltf_.views[source.view];
    return std::string_view(gltf_.buffers[view.buffer]).substr(view.offset, view.length);
  }

  void unpack_primitive(const DracoSource& source, Unpacked& unpacked) {
    const Primitive& p = primitive_of(source);
    std::unordered_map<std::string_view, std::size_t> ids(source.attributes.begin(),
                                                          source.attributes.end());
    Json& primitive = patched_.json["meshes"][p.mesh]["primitives"][p.number];
    for (auto& [semantic, accessor] : primitive["attributes"].items()) {
      const auto id = ids.find(semantic);
      if (id == ids.end()) continue;
      accessor = attribute(accessor.get<std::size_t>(), id->second, unpacked);
      ids.erase(id);
    }
    if (!ids.empty())
      fail(ErrorCode::malformed_draco, place_of(source).at("attributes"),
           "the primitive itself has no attribute " + std::string(ids.begin()->first) +
               "; compress the asset again");
    primitive["indices"] = indices(p.indices, unpacked);
    if (primitive.contains("mode")) primitive["mode"] = Mode::triangles;  // as Draco's faces are
    remove_extension(primitive, kExtension);
  }

  std::size_t attribute(std::size_t old, std::size_t id, Unpacked& unpacked) {
    const auto [found, is_new] = attributes_.try_emplace({old, id});
    if (is_new)
      found->second =
          put(old, unpacked.attribute(gltf_.accessors[old], gltf_.json["accessors"][old], id));
    return found->second;
  }

  std::size_t indices(std::optional<std::size_t> old, Unpacked& unpacked) {
    const auto [found, is_new] = indices_.try_emplace(old);
    if (is_new)
      found->second = old ? put(*old, unpacked.indices(old)) : append(unpacked.indices(old));
    return found->second;
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
  ReadLimits left_;  ///< what all later bitstreams together may still contain
  PatchedDocument patched_;
  NewViews views_;
  /// Of the present bitstream: the new accessor for each old one and attribute.
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> attributes_;
  std::map<std::optional<std::size_t>, std::size_t> indices_;
  std::set<std::size_t> filled_;
};

/// The sources grouped by their run of bytes, in the order of their first.
std::vector<Sharers> by_bitstream(const Gltf& gltf, const std::vector<DracoSource>& sources) {
  std::vector<Sharers> bitstreams;
  std::map<std::tuple<std::size_t, std::size_t, std::size_t>, std::size_t> number_of;
  for (const DracoSource& source : sources) {
    const View& view = gltf.views[source.view];
    const auto [found, is_new] =
        number_of.try_emplace({view.buffer, view.offset, view.length}, bitstreams.size());
    if (is_new) bitstreams.emplace_back();
    bitstreams[found->second].push_back(&source);
  }
  return bitstreams;
}

}  // namespace

void decode_draco(Gltf& gltf, const std::vector<DracoSource>& sources, const ReadLimits& limits) {
  Unpacker unpacker(gltf, limits);
  for (const Sharers& sharers : by_bitstream(gltf, sources)) unpacker.unpack(sharers);
  PatchedDocument unpacked = unpacker.finish();
  gltf.json = std::move(unpacked.json);
  for (const DracoSource& source : sources) gltf.spent_views.push_back(source.view);
  add_buffer(gltf, std::move(unpacked.added));
}

}  // namespace unwrapd::asset::codec
