// While materials are rewritten, new textures have numbers after those of all old ones; then the
// numbers of their places. The same holds for images.
#include "core/asset/writer/texture_entries.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "core/asset/gltf/extensions.hpp"
#include "core/asset/gltf/material_textures.hpp"
#include "core/asset/gltf/materials.hpp"

namespace unwrapd::asset::writer {
namespace {

constexpr int kClampToEdge = 33071;

std::size_t size_of(const Json& document, const char* list) {
  const auto found = document.find(list);
  return found != document.end() && found->is_array() ? found->size() : 0;
}

/// Calls visit with each reference of a material to a texture.
template <class Value, class Visit>
void for_each_texture_reference(Value& document, Pace& pace, const Visit& visit) {
  const auto materials = document.find("materials");
  if (materials == document.end()) return;
  for (auto& material : *materials)
    for_each_texture(material, pace, [&](const std::string& /*key*/, auto& info) {
      if (info["index"].is_number_unsigned()) visit(info["index"]);
    });
}

/// Calls visit with each reference of a texture to an image.
template <class Value, class Visit>
void for_each_image_reference(Value& document, const Visit& visit) {
  const auto visit_in = [&](auto& object) {
    if (!object.is_object()) return;
    const auto source = object.find("source");
    if (source != object.end() && source->is_number_unsigned()) visit(*source);
  };
  const auto textures = document.find("textures");
  if (textures == document.end() || !textures->is_array()) return;
  for (auto& texture : *textures) {
    visit_in(texture);
    const auto extensions = texture.is_object() ? texture.find("extensions") : texture.end();
    if (!texture.is_object() || extensions == texture.end()) continue;
    if (extensions->is_object())
      for (auto& extension : *extensions) visit_in(extension);
  }
}

/// Entries of a list: which old ones are no longer in use, and where the new ones go.
class Places {
 public:
  /// before, now: the old entries that were and are referred to.
  Places(std::size_t old_count, std::size_t new_count, const std::set<std::size_t>& before,
         const std::set<std::size_t>& now)
      : old_count_(old_count) {
    for (const std::size_t entry : before)
      if (!now.contains(entry)) free_.push_back(entry);
    for (std::size_t k = 0; k < new_count; ++k)
      places_.push_back(k < free_.size() ? free_[k] : old_count + k - free_.size());
  }

  /// The number of a new entry in place of its provisional one.
  void settle(Json& number) const {
    const auto entry = number.get<std::size_t>();
    if (entry >= old_count_ && entry - old_count_ < places_.size())
      number = places_[entry - old_count_];
  }

  void put(Json& list, std::size_t k, Json entry) const {
    if (places_[k] < list.size())
      list[places_[k]] = std::move(entry);
    else
      list.push_back(std::move(entry));
  }

  /// Old entries that are left over.
  [[nodiscard]] std::vector<std::size_t> left_over() const {
    const std::size_t taken = std::min(free_.size(), places_.size());
    return {free_.begin() + std::ptrdiff_t(taken), free_.end()};
  }

 private:
  std::size_t old_count_;
  std::vector<std::size_t> free_, places_;
};

class EntryWriter {
 public:
  EntryWriter(const Gltf& gltf, const TransferPlan& plan, Json& document)
      : gltf_(gltf),
        plan_(plan),
        document_(document),
        pace_(gltf.stop),
        texture_count_(size_of(gltf.json, "textures")),
        image_count_(size_of(gltf.json, "images")),
        may_reuse_(!gltf.has_foreign_references &&
                   !uses_extension(gltf.json, "EXT_lights_image_based")) {}

  void run(std::vector<Json> images) {
    rewrite_materials();
    write_textures();
    write_images(std::move(images));
  }

 private:
  using Binding = std::vector<std::size_t>;  // provisional: in plan.textures; empty: unchanged

  const Binding& binding_of(std::size_t primitive, std::size_t material) const {
    static const Binding none;
    const auto found = plan_.bindings.find({primitive, material});
    return found == plan_.bindings.end() ? none : found->second;
  }

  /// Each kind of user gets a material of its own; the first one the old number, unless a user
  /// reads what it read before.
  void rewrite_materials() {
    std::map<std::size_t, std::set<Binding>> kinds;  // [material]
    for (std::size_t i = 0; i < gltf_.primitives.size(); ++i)
      for_each_material(json_of(gltf_.json, gltf_.primitives[i]), [&](const Json& number) {
        pace_.add(4);
        const auto material = number.get<std::size_t>();
        kinds[material].insert(binding_of(i, material));
      });
    std::map<std::pair<std::size_t, Binding>, std::size_t> numbers;
    for (const auto& [material, bindings] : kinds)
      for (const Binding& binding : bindings)
        if (!binding.empty())
          numbers[{material, binding}] = rewritten(material, binding, binding == *bindings.begin());
    for (std::size_t i = 0; i < gltf_.primitives.size(); ++i)
      for_each_material(json_of(document_, gltf_.primitives[i]), [&](Json& number) {
        const auto material = number.get<std::size_t>();
        const auto found = numbers.find({material, binding_of(i, material)});
        if (found != numbers.end()) number = found->second;
      });
  }

  /// Returns the number of the rewritten material.
  std::size_t rewritten(std::size_t number, const Binding& binding, bool in_place) {
    Json& materials = document_["materials"];
    Json material = gltf_.json.at("materials").at(number);
    auto next = binding.begin();
    for_each_texture(material, pace_, [&](const std::string& /*key*/, Json& info) {
      if (set_name(texcoord_of(info)) == gltf_.texcoord) info["index"] = texture_count_ + *next++;
    });
    reset_transforms(material, gltf_.texcoord, pace_);
    if (!in_place) number = materials.size();
    if (in_place)
      materials[number] = std::move(material);
    else
      materials.push_back(std::move(material));
    return number;
  }

  void write_textures() {
    std::set<std::size_t> before, now;
    for_each_texture_reference(gltf_.json, pace_,
                               [&](const Json& index) { before.insert(index.get<std::size_t>()); });
    for_each_texture_reference(document_, pace_,
                               [&](const Json& index) { now.insert(index.get<std::size_t>()); });
    const Places places(texture_count_, plan_.textures.size(), may_reuse_ ? before : now, now);
    for_each_texture_reference(document_, pace_, [&](Json& index) { places.settle(index); });
    std::vector<Json> entries;
    for (const NewTexture& texture : plan_.textures) entries.push_back(entry_of(texture));
    Json& textures = document_["textures"];           // after members were added to the document
    for (const std::size_t old : places.left_over())  // refers to the new image of its old one
      for (std::size_t k = 0; k < entries.size(); ++k)
        if (plan_.images[plan_.textures[k].image].image == source_image(gltf_, old))
          textures[old] = entries[k];
    for (std::size_t k = 0; k < entries.size(); ++k) places.put(textures, k, std::move(entries[k]));
  }

  /// The old entry over a new image, and a sampler that does not repeat it.
  Json entry_of(const NewTexture& texture) {
    const Json& old = gltf_.json.at("textures").at(texture.old);
    Json entry = old;
    for (const char* stale : {"source", "sampler", "extensions"}) entry.erase(stale);
    Json sampler = {{"wrapS", kClampToEdge}, {"wrapT", kClampToEdge}};
    if (old.contains("sampler")) {
      const Json& filters = gltf_.json.at("samplers").at(old["sampler"].get<std::size_t>());
      for (const char* filter : {"magFilter", "minFilter"})
        if (filters.contains(filter)) sampler[filter] = filters[filter];
    }
    entry["sampler"] = sampler_number(sampler);
    const std::size_t image = image_count_ + texture.image;
    if (plan_.images[texture.image].head.codec == texture::Codec::webp) {
      entry["extensions"][kWebpExtension]["source"] = image;
      require_webp();
    } else {
      entry["source"] = image;
    }
    return entry;
  }

  std::size_t sampler_number(const Json& sampler) {
    Json& samplers = document_["samplers"];
    const auto found = std::find(samplers.begin(), samplers.end(), sampler);
    if (found != samplers.end()) return static_cast<std::size_t>(found - samplers.begin());
    samplers.push_back(sampler);
    return samplers.size() - 1;
  }

  void require_webp() {
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
      Json& names = document_[list];
      if (std::find(names.begin(), names.end(), Json(kWebpExtension)) == names.end())
        names.push_back(kWebpExtension);
    }
  }

  void write_images(std::vector<Json> images) {
    std::set<std::size_t> before, now;
    for_each_image_reference(gltf_.json,
                             [&](const Json& image) { before.insert(image.get<std::size_t>()); });
    for_each_image_reference(document_,
                             [&](const Json& image) { now.insert(image.get<std::size_t>()); });
    const Places places(image_count_, images.size(), may_reuse_ ? before : now, now);
    for_each_image_reference(document_, [&](Json& image) { places.settle(image); });
    Json& list = document_["images"];
    for (std::size_t k = 0; k < images.size(); ++k) {
      const Json& old = gltf_.json.at("images").at(plan_.images[k].image);
      for (const char* kept : {"name", "extras"})
        if (old.contains(kept)) images[k][kept] = old[kept];
      places.put(list, k, std::move(images[k]));
    }
  }

  const Gltf& gltf_;
  const TransferPlan& plan_;
  Json& document_;
  Pace pace_;
  std::size_t texture_count_, image_count_;
  bool may_reuse_;
};

}  // namespace

void write_entries(const Gltf& gltf, const TransferPlan& plan, std::vector<Json> images,
                   Json& document) {
  if (!plan.images.empty()) EntryWriter(gltf, plan, document).run(std::move(images));
}

}  // namespace unwrapd::asset::writer
