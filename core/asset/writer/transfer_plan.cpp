// New images are found greedily, in the order of primitives: a use goes into the first image of its
// old image and content whose faces are others, or are read in the same way.
#include "core/asset/writer/transfer_plan.hpp"

#include <algorithm>
#include <optional>

#include "core/asset/base/as_size.hpp"
#include "core/asset/gltf/elements.hpp"
#include "core/asset/gltf/materials.hpp"

namespace unwrapd::asset::writer {
namespace {

constexpr int kMostSide = 8192;      // of a new texture, unless the page is larger
constexpr double kTolerated = 1.05;  // texels of the old image for one of the new, along a line

std::size_t uv_accessor_of(const Gltf& gltf, const Primitive& primitive) {
  const auto is_set = [&](const auto& item) { return item.first == gltf.texcoord; };
  return std::ranges::find_if(primitive.attributes, is_set)->second;
}

class Planner {
 public:
  explicit Planner(const Gltf& gltf) : gltf_(gltf), pace_(gltf.stop) {}

  TransferPlan run() {
    for (std::size_t i = 0; i < gltf_.primitives.size(); ++i) {
      const Primitive& primitive = gltf_.primitives[i];
      if (!primitive.has_triangles || !has_set(gltf_, primitive, gltf_.texcoord)) continue;
      for_each_material(json_of(gltf_.json, primitive),
                        [&](const Json& number) { bind(i, number.get<std::size_t>()); });
    }
    return std::move(plan_);
  }

 private:
  void bind(std::size_t primitive, std::size_t material) {
    const auto [binding, is_new] = plan_.bindings.try_emplace({primitive, material});
    if (!is_new) return;
    auto [slots, is_unread] = slots_.try_emplace(material);
    if (is_unread) slots->second = slots_of(gltf_, material, pace_);
    for (const TextureSlot& slot : slots->second) {
      pace_.add(4);
      const NewTexture texture{image_for(slot, {primitive, slot.mapping}), slot.texture};
      const auto [number, is_other] = textures_.try_emplace(texture, plan_.textures.size());
      if (is_other) plan_.textures.push_back(texture);
      binding->second.push_back(number->second);
    }
    if (slots->second.empty()) plan_.bindings.erase(binding);
  }

  std::size_t image_for(const TextureSlot& slot, const TextureUse& use) {
    std::vector<std::size_t>& candidates = images_[{slot.image, slot.content}];
    for (const std::size_t candidate : candidates)
      if (takes(candidate, use)) return candidate;
    const std::size_t number = plan_.images.size();
    plan_.images.emplace_back();
    plan_.images.back().image = slot.image;
    plan_.images.back().content = slot.content;
    readers_.emplace_back();
    candidates.push_back(number);
    takes(number, use);
    return number;
  }

  /// Adds the use to the image, unless its faces are read there in another way.
  bool takes(std::size_t image, const TextureUse& use) {
    const Primitive& primitive = gltf_.primitives[use.primitive];
    const Reader reader{uv_accessor_of(gltf_, primitive), use.mapping};
    const auto [found, is_new] = readers_[image].try_emplace(primitive.piece, reader);
    if (is_new) plan_.images[image].uses.push_back(use);
    return found->second == reader;
  }

  struct Reader {
    std::size_t uv_accessor;
    TextureMapping mapping;

    bool operator==(const Reader&) const = default;
  };

  const Gltf& gltf_;
  Pace pace_;
  TransferPlan plan_;
  std::map<std::size_t, std::vector<TextureSlot>> slots_;  ///< [material]
  std::map<NewTexture, std::size_t> textures_;
  std::map<std::pair<std::size_t, texture::Content>, std::vector<std::size_t>> images_;
  std::vector<std::map<std::size_t, Reader>> readers_;  ///< [new image][piece]
};

/// The page, doubled until the detail is kept. needed: as a multiple of the page's sides.
void set_size(NewImage& image, double needed, const texture::Size& page) {
  const int longer = std::max(page.width, page.height), most = std::max(kMostSide, longer);
  int scale = 1;
  while (scale * kTolerated < needed && 2 * scale * longer <= most) scale *= 2;
  image.size = {scale * page.width, scale * page.height};
  image.is_reduced = scale * kTolerated < needed;
}

void size_image(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped, NewImage& image) {
  std::string storage;
  image.head = texture::head_of(image_file(gltf, image.image, storage));
  std::vector<texture::Patch> patches;
  for (const TextureUse& use : image.uses) patches.push_back(patch_of(gltf, unwrapped, use));
  const texture::Size page{gltf.transfer->page.width, gltf.transfer->page.height};
  const texture::Size old{image.head.width, image.head.height};
  set_size(image, texture::scale_that_keeps_detail(patches, page, old, gltf.stop), page);
}

Eigen::Vector2f downwards(const Vec2& uv) {
  return {static_cast<float>(uv.x()), static_cast<float>(1 - uv.y())};
}

}  // namespace

TransferPlan plan_transfer(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped) {
  TransferPlan plan = Planner(gltf).run();
  for (NewImage& image : plan.images) size_image(gltf, unwrapped, image);
  return plan;
}

std::vector<std::array<std::size_t, 3>> face_vertices(const Gltf& gltf,
                                                      std::span<const UnwrappedSurface> unwrapped,
                                                      const Primitive& primitive) {
  const Piece& piece = gltf.pieces[primitive.piece];
  const UnwrappedSurface& surface = unwrapped[piece.surface];
  std::vector<std::array<std::size_t, 3>> faces(piece.face_count);
  for (std::size_t t = 0; t < piece.face_count; ++t) {
    check_cancelled_every(t, gltf.stop);
    for (std::size_t k = 0; k < 3; ++k) {
      const Index corner = surface.faces[piece.first_face + t][k];
      const Index vertex = surface.source[as_size(corner)];
      faces[t][k] = as_size(gltf.vertices[piece.surface][as_size(vertex)]);
    }
  }
  return faces;
}

texture::Patch patch_of(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped,
                        const TextureUse& use) {
  const Primitive& primitive = gltf.primitives[use.primitive];
  const Piece& piece = gltf.pieces[primitive.piece];
  const UnwrappedSurface& surface = unwrapped[piece.surface];
  const Elements uv(gltf, uv_accessor_of(gltf, primitive));
  const auto vertices = face_vertices(gltf, unwrapped, primitive);
  texture::Patch patch{
      use.mapping.sampling, std::vector<texture::PlacedTriangle>(vertices.size()), {}};
  for (std::size_t t = 0; t < vertices.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t corner = as_size(surface.faces[piece.first_face + t][k]);
      patch.triangles[t].from[k] = use.mapping(uv.vec2_at(vertices[t][k])).cast<float>();
      patch.triangles[t].to[k] = downwards(surface.uv[corner]);
    }
  return patch;
}

}  // namespace unwrapd::asset::writer
