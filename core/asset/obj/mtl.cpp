// A map statement is "map_Kd -o 0 0 0 -bm 0.5 name with spaces.png": options with a fixed number of
// words each come first, and the name is the rest.
#include "core/asset/obj/mtl.hpp"

#include <algorithm>
#include <cmath>

#include "core/asset/base/words.hpp"
#include "core/base/lower_case.hpp"

namespace unwrapd::asset::obj {
namespace {

struct MapStatement {
  std::string path;
  double scale = 1;  ///< -bm
};

bool is_number(std::string_view word) { return number_in(word).has_value(); }

/// The words that follow an option; -o, -s and -t have one to three numbers.
std::size_t words_of(std::string_view option) {
  if (option == "-mm") return 2;
  return option == "-o" || option == "-s" || option == "-t" ? 3 : 1;
}

MapStatement read_map(Words words) {
  MapStatement map;
  for (Words ahead = words;; ahead = words) {
    const std::string_view option = ahead.next();
    const bool is_option = option.size() > 1 && option.front() == '-' && !is_number(option);
    if (!is_option) break;
    for (std::size_t k = 0; k < words_of(option); ++k) {
      Words value = ahead;
      const std::string_view word = value.next();
      if (k > 0 && !is_number(word)) break;
      if (const auto scale = number_in(word); option == "-bm" && scale && std::isfinite(*scale))
        map.scale = *scale;
      ahead = value;
    }
    words = ahead;
  }
  map.path = plain_path(words.rest());
  return map;
}

/// Whether a map_Bump names a map of normals rather than of heights: the statement is for both.
bool names_normals(std::string_view path) {
  const std::string name = lower_case(path.substr(path.rfind('/') + 1));
  const std::string stem = name.substr(0, name.rfind('.'));
  const auto has = [&](std::string_view part) { return stem.find(part) != std::string::npos; };
  return has("norm") || has("nrm") || has("nmap") || stem.ends_with("_n") || stem.ends_with("_nor");
}

void read_share(Words words, double& value) {
  if (const std::optional<double> number = number_in(words.next());
      number && std::isfinite(*number))
    value = std::clamp(*number, 0.0, 1.0);
}

/// Of one to three numbers; one is a grey. A spectral curve or CIE XYZ is passed over.
void read_colour(Words words, std::array<double, 3>& colour) {
  std::array<double, 3> read{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string_view word = words.next();
    const std::optional<double> number = word.empty() && k > 0 ? read[0] : number_in(word);
    if (!number || !std::isfinite(*number)) return;
    read[k] = std::clamp(*number, 0.0, 1.0);
  }
  colour = read;
}

void read_normals(const std::string& keyword, const Words& words, MtlMaterial& material) {
  const MapStatement map = read_map(words);
  if (keyword != "norm" && !names_normals(map.path)) {
    material.dropped.push_back(keyword);
    return;
  }
  material.normal_map = map.path;
  material.normal_scale = map.scale;
}

void read_map_statement(const std::string& keyword, const Words& words, MtlMaterial& material) {
  if (keyword == "map_kd")
    material.colour_map = read_map(words).path;
  else if (keyword == "map_ke")
    material.emission_map = read_map(words).path;
  else if (keyword == "map_d")
    material.alpha_map = read_map(words).path;
  else if (keyword == "norm" || keyword == "bump" || keyword == "map_bump")
    read_normals(keyword, words, material);
  else
    material.dropped.push_back(keyword);
}

void read_number(const std::string& keyword, Words words, MtlMaterial& material) {
  if (keyword == "d" && words.rest().starts_with("-halo")) words.next();
  if (keyword == "d") read_share(words, material.alpha);
  if (keyword == "pm") read_share(words, material.metallic);
  if (keyword == "pr") read_share(words, material.roughness.emplace(1));
  if (keyword == "tr") {
    double transparency = 1 - material.alpha;
    read_share(words, transparency);
    material.alpha = 1 - transparency;
  }
  if (keyword == "ns") material.shininess = std::max(0.0, number_in(words.next()).value_or(0));
}

void read_statement(std::string_view statement, MtlMaterial& material) {
  Words words(statement);
  const std::string keyword = lower_case(words.next());
  if (keyword == "kd")
    read_colour(words, material.colour);
  else if (keyword == "ke")
    read_colour(words, material.emission);
  else if (keyword.starts_with("map_") || keyword == "norm" || keyword == "bump" ||
           keyword == "disp" || keyword == "decal" || keyword == "refl")
    read_map_statement(keyword, words, material);
  else
    read_number(keyword, words, material);
}

}  // namespace

std::string plain_path(std::string_view path) {
  std::string plain(path);
  if (plain.size() > 1 && plain.front() == '"' && plain.back() == '"')
    plain = plain.substr(1, plain.size() - 2);
  std::ranges::replace(plain, '\\', '/');
  while (plain.starts_with("./")) plain.erase(0, 2);
  const bool leads_out = plain.starts_with('/') || plain.find(':') != std::string::npos ||
                         plain.starts_with("../") || plain.find("/../") != std::string::npos;
  return leads_out ? plain.substr(plain.find_last_of("/:") + 1) : plain;
}

void read_mtl(std::string_view text, Pace& pace, MtlLibrary& library) {
  std::string plain(text);
  replace_lone_returns(plain);
  MtlMaterial unnamed;
  MtlMaterial* material = &unnamed;
  for (Statement at; at.next < plain.size();) {
    at = statement_at(plain, at.next);
    pace.add(1 + (at.next - at.begin) / 16);
    const auto statement = std::string_view(plain).substr(at.begin, at.end - at.begin);
    Words words(statement);
    if (lower_case(words.next()) != "newmtl") {
      read_statement(statement, *material);
      continue;
    }
    const auto [entry, is_new] = library.try_emplace(std::string(words.rest()));
    material = is_new ? &entry->second : &unnamed;
  }
}

}  // namespace unwrapd::asset::obj
