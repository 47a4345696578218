// Images that were sent are included. Others are referred to by their paths, as a .gltf does: they
// may lie beside the result. glTF knows PNG and JPEG alone.
#include "core/asset/obj/materials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/words.hpp"
#include "core/asset/gltf/images.hpp"
#include "core/base/lower_case.hpp"

namespace unwrapd::asset::obj {
namespace {

std::string name_of(const std::string& path) { return path.substr(path.rfind('/') + 1); }

/// The files of the request by their plain paths.
class SentFiles {
 public:
  using File = std::pair<const std::string, std::string_view>;

  explicit SentFiles(const Input& input) {
    for (const auto& [uri, bytes] : input.buffers) by_path_.emplace(plain_path(uri), bytes);
    for (const File& file : by_path_) {
      const auto [known, is_new] = by_name_.try_emplace(name_of(file.first), &file);
      if (!is_new) known->second = nullptr;
    }
  }

  /// The file of this path, or else the only one of its name in any folder.
  [[nodiscard]] const File* find(const std::string& path) const {
    if (const auto found = by_path_.find(path); found != by_path_.end()) return &*found;
    const auto only = by_name_.find(name_of(path));
    return only == by_name_.end() ? nullptr : only->second;
  }

 private:
  std::map<std::string, std::string_view> by_path_;
  std::map<std::string, const File*> by_name_;  ///< null: several
};

std::array<const std::string*, 3> maps_of(const MtlMaterial& look) {
  return {&look.colour_map, &look.emission_map, &look.normal_map};
}

/// Visits the materials that are read, of those that the OBJ names.
template <class Visit>
void for_each_look(const Obj& obj, const Visit& visit) {
  const std::set<std::string> names(obj.materials.begin(), obj.materials.end());
  for (const std::string& name : names)
    if (const auto look = obj.looks.find(name); look != obj.looks.end()) visit(look->second);
}

bool has_ending(const std::string& path, std::string_view ending) {
  if (path.size() < ending.size()) return false;
  return std::equal(ending.begin(), ending.end(), path.end() - std::ptrdiff_t(ending.size()),
                    [](char a, char b) { return a == lower_letter(b); });
}

/// The type by the first bytes; of an image that was not sent by its name. Empty: not for a glTF.
std::string_view media_type(const Obj& obj, const std::string& path) {
  const auto sent = obj.images.find(path);
  if (sent != obj.images.end()) {
    const std::string_view type = asset::media_type(sent->second);
    return type == "image/png" || type == "image/jpeg" ? type : "";
  }
  if (has_ending(path, ".png")) return "image/png";
  return has_ending(path, ".jpg") || has_ending(path, ".jpeg") ? "image/jpeg" : "";
}

bool is_usable(const Obj& obj, const std::string& path) {
  return !path.empty() && !media_type(obj, path).empty();
}

/// The path as a URI: RFC 3986 leaves these characters as they are.
std::string uri_of(const std::string& path) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string uri;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') ||
                          std::string_view("-._~/").find(c) != std::string_view::npos;
    if (is_plain)
      uri += c;
    else
      uri.append({'%', kHex[byte >> 4U], kHex[byte & 15U]});
  }
  return uri;
}

/// Whatever bytes the name has, the document is UTF-8.
Json name_json(const std::string& name) {
  return Json::parse(Json(name).dump(-1, ' ', false, Json::error_handler_t::replace));
}

class MaterialWriter {
 public:
  MaterialWriter(const Obj& obj, NewViews& views, Json& json)
      : obj_(obj), views_(views), json_(json) {}

  Json material(const std::string& name) {
    Json material = {{"name", name_json(name)}};
    if (const auto look = obj_.looks.find(name); look != obj_.looks.end())
      dress(look->second, material);
    return material;
  }

 private:
  void dress(const MtlMaterial& look, Json& material) {
    const bool is_textured = is_usable(obj_, look.colour_map);
    const bool is_black = look.colour == std::array<double, 3>{0, 0, 0};
    std::array<double, 3> colour = look.colour;
    if (is_textured && is_black) colour = {1, 1, 1};  // written by exporters that mean the image
    Json& surface = material["pbrMetallicRoughness"];
    surface["baseColorFactor"] = {colour[0], colour[1], colour[2], look.alpha};
    if (is_textured) surface["baseColorTexture"] = texture(look.colour_map);
    surface["metallicFactor"] = look.metallic;
    surface["roughnessFactor"] = look.roughness.value_or(std::sqrt(2 / (look.shininess + 2)));
    if (is_usable(obj_, look.normal_map)) {
      material["normalTexture"] = texture(look.normal_map);
      if (look.normal_scale != 1) material["normalTexture"]["scale"] = look.normal_scale;
    }
    add_emission(look, material);
    const bool is_cut_out = is_textured && look.alpha_map == look.colour_map;
    if (look.alpha < 1 || is_cut_out) material["alphaMode"] = "BLEND";
  }

  void add_emission(const MtlMaterial& look, Json& material) {
    std::array<double, 3> emission = look.emission;
    const bool is_black = emission == std::array<double, 3>{0, 0, 0};
    if (is_usable(obj_, look.emission_map)) {
      material["emissiveTexture"] = texture(look.emission_map);
      if (is_black) emission = {1, 1, 1};
    } else if (is_black) {
      return;
    }
    material["emissiveFactor"] = emission;
  }

  Json texture(const std::string& path) {
    const auto [known, is_new] = textures_.try_emplace(path, textures_.size());
    if (is_new) {
      json_["textures"].push_back({{"source", json_["images"].size()}});
      json_["images"].push_back(image(path));
    }
    return {{"index", known->second}};
  }

  Json image(const std::string& path) {
    const auto sent = obj_.images.find(path);
    if (sent == obj_.images.end()) return {{"uri", uri_of(path)}};
    return {{"bufferView", views_.add(sent->second, 0, 0)}, {"mimeType", media_type(obj_, path)}};
  }

  const Obj& obj_;
  NewViews& views_;
  Json& json_;
  std::map<std::string, std::size_t> textures_;
};

/// "map_ks" and such, of all materials, each once.
std::string dropped_statements(const Obj& obj) {
  std::set<std::string> dropped;
  for_each_look(obj, [&](const MtlMaterial& look) {
    dropped.insert(look.dropped.begin(), look.dropped.end());
    if (!look.alpha_map.empty() && look.alpha_map != look.colour_map) dropped.insert("map_d");
    for (const std::string* map : maps_of(look))
      if (!map->empty() && !is_usable(obj, *map)) dropped.insert("images other than PNG and JPEG");
  });
  std::string text;
  for (const std::string& one : dropped) text += (text.empty() ? "" : ", ") + one;
  return text;
}

/// The images that are only referred to.
std::set<std::string> images_beside(const Obj& obj) {
  std::set<std::string> beside;
  for_each_look(obj, [&](const MtlMaterial& look) {
    for (const std::string* map : maps_of(look))
      if (is_usable(obj, *map) && !obj.images.contains(*map)) beside.insert(*map);
  });
  return beside;
}

/// Takes the images that were sent, each once, and names them in the materials by the paths of
/// their files: an OBJ may have many paths to one.
void take_images(const SentFiles& files, Obj& obj) {
  const std::set<std::string> names(obj.materials.begin(), obj.materials.end());
  for (const std::string& name : names) {
    const auto look = obj.looks.find(name);
    if (look == obj.looks.end()) continue;
    MtlMaterial& own = look->second;
    for (std::string* map : {&own.colour_map, &own.emission_map, &own.normal_map, &own.alpha_map}) {
      const SentFiles::File* file = map->empty() ? nullptr : files.find(*map);
      if (file == nullptr) continue;
      *map = file->first;
      if (map != &own.alpha_map) obj.images.try_emplace(file->first, file->second);
    }
  }
}

/// What of the OBJ's text, beside its materials, a glTF of it does not have.
std::string dropped_parts(const Obj& obj) {
  const auto is_line = [](const Element& element) { return element.keyword == 'l'; };
  bool is_image = false;
  for_each_look(obj, [&](const MtlMaterial& own) { is_image |= is_usable(obj, own.colour_map); });
  std::string text;
  const auto add = [&](bool holds, const char* what) {
    if (holds) text += (text.empty() ? "" : ", ") + std::string(what);
  };
  add(!obj.colours.empty() && is_image, "colours of vertices where the material has an image");
  add(std::ranges::any_of(obj.elements, is_line), "lines");
  add(obj.has_points, "points");
  add(obj.has_names, "names of objects and groups");
  return text;
}

}  // namespace

void read_materials(const Input& input, Obj& obj) {
  const SentFiles files(input);
  Pace pace(input.stop);
  std::set<const SentFiles::File*> done;
  const auto read = [&](const std::string& path) {
    const SentFiles::File* file = files.find(path);
    if (file != nullptr && done.insert(file).second) read_mtl(file->second, pace, obj.looks);
    return file != nullptr;
  };
  for (const std::string& library : obj.libraries) {
    pace.add(1);
    if (read(plain_path(library))) continue;
    Words words(library);  // several files, or one with spaces in its name
    for (std::string_view word = words.next(); !word.empty(); word = words.next())
      read(plain_path(word));
  }
  take_images(files, obj);
}

bool keeps_texcoords(const Obj& obj, const AssetOptions& options) {
  if (obj.texcoord_lines.empty() || std::holds_alternative<int>(options.texcoord)) return false;
  bool has_textures = false;
  for_each_look(obj, [&](const MtlMaterial& look) {
    for (const std::string* map : maps_of(look)) has_textures |= is_usable(obj, *map);
  });
  return has_textures;
}

bool has_image(const Obj& obj, Index part) {
  const auto look = obj.looks.find(obj.materials[as_size(part)]);
  return look != obj.looks.end() && is_usable(obj, look->second.colour_map);
}

void add_materials(const Obj& obj, std::span<const Index> parts, NewViews& views, Json& json) {
  Json used = Json::array();
  MaterialWriter writer(obj, views, json);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const std::string& name = obj.materials[as_size(parts[k])];
    if (name.empty()) continue;
    json["meshes"][0]["primitives"][k]["material"] = used.size();
    used.push_back(writer.material(name));
  }
  if (!used.empty()) json["materials"] = std::move(used);
}

std::vector<Note> note_on_materials(const Obj& obj) {
  std::size_t count = 0, read = 0;
  for (const std::string& name : obj.materials) count += name.empty() ? 0 : 1;
  for_each_look(obj, [&](const MtlMaterial&) { ++read; });
  std::vector<Note> notes;
  if (read < count || (count == 0 && !obj.libraries.empty() && obj.looks.empty()))
    notes.push_back({NoteCode::data_dropped,
                     "The result has the names of the OBJ's materials (" +
                         std::to_string(count - read) +
                         "), without their colours and textures: no file that mtllib names and "
                         "that tells them was sent. Send it and its images with the OBJ, as parts "
                         "of a form or in a zip archive."});
  if (const std::string dropped = dropped_statements(obj); !dropped.empty())
    notes.push_back({NoteCode::data_dropped,
                     "The result lacks these parts of the OBJ's materials, which are not "
                     "converted: " +
                         dropped + "."});
  if (const std::string dropped = dropped_parts(obj); !dropped.empty())
    notes.push_back({NoteCode::data_dropped,
                     "The result lacks these parts of the OBJ, which are not converted: " +
                         dropped + ". Send output=obj to keep them."});
  const std::set<std::string> beside = images_beside(obj);
  if (!beside.empty())
    notes.push_back({NoteCode::images_separate,
                     std::to_string(beside.size()) + (beside.size() == 1 ? " image" : " images") +
                         " of the OBJ's materials, such as " + *beside.begin() +
                         ", remain in separate files; keep them beside the result, or send them "
                         "with the OBJ."});
  return notes;
}

}  // namespace unwrapd::asset::obj
