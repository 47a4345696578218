#include "core/asset/writer/transfer_textures.hpp"

#include <algorithm>

#include "core/asset/writer/texture_entries.hpp"

namespace unwrapd::asset::writer {
namespace {

constexpr std::size_t kMostNamed = 8;  // images that a note names

std::size_t texels(const texture::Size& size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

std::string size_text(const texture::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

/// The old image with its mip chain; the new one with its offsets, and as its encoder keeps it.
void check_memory(const Gltf& gltf, const NewImage& image, std::size_t faces) {
  constexpr std::size_t kOfFace = sizeof(texture::PlacedTriangle) + sizeof(texture::TurnedFrames);
  const std::size_t deep = image.head.is_deep ? 1 : 0;
  const std::size_t bytes = texture::decoding_bytes(image.head) +
                            (6 + 6 * deep) * texels({image.head.width, image.head.height}) +
                            (17 + 8 * deep) * texels(image.size) + 2 * kOfFace * faces;
  if (bytes > gltf.transfer->max_bytes / 2)
    throw Error(ErrorCode::too_much_memory,
                "to resample this image to " + size_text(image.size) +
                    " texels takes more memory than a job may; send a "
                    "smaller image or a lower resolution",
                Place().at("images").at(image.image).pointer());
}

class ImagePainter {
 public:
  ImagePainter(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped,
               const WrittenTangents& tangents)
      : gltf_(gltf), unwrapped_(unwrapped), tangents_(tangents) {}

  /// The new image's file.
  [[nodiscard]] std::string paint(const NewImage& image) const {
    const bool has_vectors =
        image.content == texture::Content::normals || image.content == texture::Content::directions;
    texture::Painted painted = painted_by(image, patches_of(image, has_vectors));
    texture::dilate(painted, gltf_.stop);
    texture::ImageHead head = image.head;
    head.is_grey = head.is_grey && !has_vectors;
    return texture::encode(painted.image, head, gltf_.stop);
  }

 private:
  [[nodiscard]] std::vector<texture::Patch> patches_of(const NewImage& image,
                                                       bool has_vectors) const {
    std::size_t faces = 0;
    for (const TextureUse& use : image.uses)
      faces += gltf_.pieces[gltf_.primitives[use.primitive].piece].face_count;
    check_memory(gltf_, image, faces);
    std::vector<texture::Patch> patches;
    for (const TextureUse& use : image.uses) {
      patches.push_back(patch_of(gltf_, unwrapped_, use));
      if (has_vectors) set_frames(gltf_, unwrapped_, use, tangents_, patches.back());
    }
    return patches;
  }

  [[nodiscard]] texture::Painted painted_by(const NewImage& image,
                                            const std::vector<texture::Patch>& patches) const {
    std::string storage;
    const texture::ImageFile file = image_file(gltf_, image.image, storage);
    const texture::Texture old(texture::decode(file, image.head, gltf_.stop),
                               image.content == texture::Content::colour, gltf_.stop);
    return texture::resample(old, patches, image.size, image.content, gltf_.stop);
  }

  const Gltf& gltf_;
  std::span<const UnwrappedSurface> unwrapped_;
  const WrittenTangents& tangents_;
};

std::string images_text(const TransferPlan& plan) {
  std::string text;
  for (std::size_t i = 0; i < std::min(plan.images.size(), kMostNamed); ++i) {
    const NewImage& image = plan.images[i];
    text += (i == 0 ? "" : ", ") + std::string("image ") + std::to_string(image.image) + " from " +
            size_text({image.head.width, image.head.height}) + " to " + size_text(image.size);
  }
  return text + (plan.images.size() > kMostNamed ? ", and others" : "");
}

}  // namespace

void transfer_textures(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped,
                       const WrittenTangents& tangents, Json& document, NewViews& views) {
  const TransferPlan plan = plan_transfer(gltf, unwrapped);
  const ImagePainter painter(gltf, unwrapped, tangents);
  std::vector<Json> images;
  std::size_t bytes = 0;
  for (const NewImage& image : plan.images) {
    std::string file = painter.paint(image);
    if ((bytes += file.size()) > gltf.transfer->max_bytes / 4)
      throw Error(ErrorCode::too_much_memory,
                  "the resampled images take more memory than a job may; send fewer of them, or a "
                  "lower resolution");
    Json entry = {{"mimeType", texture::media_type(image.head.codec)},
                  {"bufferView", views.add(std::move(file), 0, 0)}};
    images.push_back(std::move(entry));
  }
  write_entries(gltf, plan, std::move(images), document);
}

std::vector<Note> notes_on_transfer(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped) {
  const TransferPlan plan = plan_transfer(gltf, unwrapped);
  const std::size_t count = plan.images.size();
  if (count == 0)
    return {{NoteCode::option_unused, "No texture of the asset samples " + gltf.texcoord +
                                          "; the option textures has no effect."}};
  std::string text = std::to_string(count) + (count == 1 ? " image is" : " images are") +
                     " resampled for the new " + gltf.texcoord +
                     ", in texels: " + images_text(plan) + ".";
  if (std::ranges::any_of(plan.images, &NewImage::is_reduced))
    text += " Repeated images lose detail; keep those by texcoord=auto without textures=transfer.";
  return {{NoteCode::textures_transferred, text}};
}

}  // namespace unwrapd::asset::writer
