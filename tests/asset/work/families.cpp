#include "tests/asset/work/families.hpp"

#include <meshoptimizer.h>

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

std::string numbered(const char* name, int i) { return name + std::to_string(i); }

MadeFile root_members(int n, const char* list, const Json& entry) {
  Builder b = square();
  Json made = {{"asset", b.json["asset"]}};
  for (int i = 0; i < n; ++i) made[numbered("x", i)] = 0;
  for (auto& [name, value] : b.json.items()) made[name] = value;
  for (int i = 0; i < n; ++i) made[list].push_back(entry);
  b.json = made;
  return {b.gltf()};
}

MadeFile shared_material(int n) {
  Builder b = square();
  const std::size_t tangents =
      b.add("VEC4", 5126, {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
  b.json["materials"] = {{{"extras", std::vector<int>(static_cast<std::size_t>(n), 7)}}};
  for (int i = 0; i < n; ++i)
    b.add_primitive({{"POSITION", 0}, {"TANGENT", tangents}}, 1)["material"] = 0;
  return {b.glb()};
}

MadeFile selected(int n, bool by_material) {
  Builder b = square();
  b.json["materials"] = {{{"name", std::string(static_cast<std::size_t>(n), 'a')}}};
  MadeFile made;
  for (int i = 0; i < n; ++i) b.add_primitive({{"POSITION", 0}}, 1)["material"] = 0;
  for (int i = 0; i < n / 10; ++i)
    by_material ? made.options.materials.push_back(b.json["materials"][0]["name"])
                : made.options.primitives.push_back(numbered("/meshes/0/primitives/", n - i));
  made.bytes = b.glb();
  return made;
}

MadeFile many_attributes(int n) {
  Builder b = square();
  Json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  for (int i = 0; i < n; ++i) {
    b.json["accessors"].push_back(b.json["accessors"][0]);
    attributes[numbered("_X", i)] = b.json["accessors"].size() - 1;
  }
  return {b.glb()};
}

MadeFile grid_of(int n, const AssetOptions& options = {}) {
  return {grid(static_cast<int>(std::sqrt(n))).glb(), options};
}

/// Views of one and the same compressed stream.
MadeFile shared_stream(int n) {
  Builder b = square();
  const auto count = static_cast<std::size_t>(n);
  const std::vector<float> zeros(3 * count);
  std::string stream(meshopt_encodeVertexBufferBound(count, 12), '\0');
  stream.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(stream.data()),
                                           stream.size(), zeros.data(), count, 12));
  b.add_view(stream);
  const Json packed = {{"buffer", 0},
                       {"byteOffset", b.bin.size() - stream.size()},
                       {"byteLength", stream.size()},
                       {"byteStride", 12},
                       {"count", count},
                       {"mode", "ATTRIBUTES"}};
  for (int i = 0; i < n; ++i) {
    b.json["bufferViews"].push_back({{"buffer", 0},
                                     {"byteLength", count * 12},
                                     {"extensions", {{"EXT_meshopt_compression", packed}}}});
    b.json["accessors"].push_back({{"bufferView", b.json["bufferViews"].size() - 1},
                                   {"componentType", 5126},
                                   {"count", count},
                                   {"type", "VEC3"}});
  }
  b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  return {b.glb()};
}

MadeFile with_extras(const Json& extras) {
  Builder b = square();
  b.json["extras"] = extras;
  b.json["nodes"][0]["extras"] = extras;
  return {b.gltf()};
}

MadeFile many_names(int n) {
  Json names = Json::object();
  auto& members = static_cast<Json::object_t::Container&>(names.get_ref<Json::object_t&>());
  for (int i = 0; i < n; ++i) members.emplace_back(numbered("x", i), 0);
  return with_extras(names);
}

MadeFile sparse(int n) {
  Builder b = grid(static_cast<int>(std::sqrt(2 * n)));
  std::string indices;
  for (int i = 0; i < n; ++i) indices.append(reinterpret_cast<const char*>(&i), sizeof i);
  const std::size_t at = b.add_view(indices);
  const std::size_t values = b.add_view(std::string(static_cast<std::size_t>(n) * 12, '\0'));
  b.json["accessors"][0]["sparse"] = {{"count", n},
                                      {"indices", {{"bufferView", at}, {"componentType", 5125}}},
                                      {"values", {{"bufferView", values}}}};
  return {b.glb()};
}

MadeFile chain_of_nodes(int n) {
  Builder b = square();
  for (int i = 1; i <= n; ++i) {
    b.json["nodes"].push_back(Json::object());
    b.json["nodes"][static_cast<std::size_t>(i - 1)]["children"] = {i};
  }
  return {b.glb()};
}

std::string repeated(const char* text, int n) {
  std::string all;
  for (int i = 0; i < n; ++i) all += text;
  return all;
}

std::string lines(const char* line, int n) {
  return "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1 2 3\n" + repeated(line, n);
}

/// A polygon that crosses itself as often as it can, with its centre last.
std::string star(int corners) {
  const int points = corners - 1;
  int step = points / 2;
  while (std::gcd(step, points) != 1) --step;
  std::string text, face = "f";
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * std::numbers::pi * i / points;
    text += "v " + std::to_string(std::cos(angle)) + ' ' + std::to_string(std::sin(angle)) + " 0\n";
    face += ' ' + std::to_string(i * step % points + 1);
  }
  return text + "v 0.001 0.0003 0\n" + face + ' ' + std::to_string(corners) + '\n';
}

/// As many nodes as surfaces, each showing all of them.
MadeFile nodes_of_many_surfaces(int n) {
  Builder b = square();
  Json all = Json::array();
  for (int i = 0; i < n; ++i) {
    b.json["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    all.push_back({{"attributes", {{"POSITION", b.json["accessors"].size() - 1}}}});
    b.json["meshes"].push_back({{"primitives", {all.back()}}});
  }
  b.json["meshes"].push_back({{"primitives", all}});
  for (int i = 0; i < n; ++i) b.json["nodes"].push_back({{"mesh", n + 1}});
  b.json.erase("scenes");
  return {b.glb()};
}

MadeFile stars(int n) {
  const std::string one = star(512);
  std::string text = one;
  for (int i = 1; i < n; ++i) text += one.substr(one.find('f'));
  return {text};
}

MadeFile numbered_lines(const char* line, int n) {
  std::string text = lines("", 0);
  for (int i = 0; i < n; ++i) text += line + std::to_string(i) + "\nf 1 2 3\n";
  return {text};
}

MadeFile one_face(int n) {
  std::string text, face = "f";
  for (int i = 1; i <= n; ++i) {
    text += "v " + std::to_string(i) + " " + std::to_string(i % 7) + " 0\n";
    face += ' ' + std::to_string(i);
  }
  return {text + face};
}

}  // namespace

std::vector<Family> gltf_families() {
  const Json mesh = {{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}};
  const Json accessor = {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}};
  const Json view = {{"buffer", 0}, {"byteLength", 4}};
  return {
      {"root and nodes", [](int n) { return root_members(n, "nodes", Json::object()); }},
      {"root and scenes", [](int n) { return root_members(n, "scenes", Json::object()); }},
      {"root and meshes", [=](int n) { return root_members(n, "meshes", mesh); }},
      {"root and accessors", [=](int n) { return root_members(n, "accessors", accessor); }},
      {"root and views", [=](int n) { return root_members(n, "bufferViews", view); }},
      {"root and images",
       [](int n) {
         return root_members(n, "images", {{"bufferView", 0}});
       }},
      {"a shared material", shared_material},
      {"materials by name", [](int n) { return selected(n, true); }},
      {"primitives by pointer", [](int n) { return selected(n, false); }},
      {"attributes", many_attributes},
      {"faces", [](int n) { return grid_of(n); }},
      {"faces, Draco", [](int n) { return grid_of(n, {.compression = Compression::draco}); }},
      {"faces, meshopt", [](int n) { return grid_of(n, {.compression = Compression::meshopt}); }},
      {"a shared stream", shared_stream},
      {"strings", [](int n) { return with_extras(std::vector<std::string>(std::size_t(n))); }},
      {"a string", [](int n) { return with_extras(std::string(std::size_t(n) * 10, 'x')); }},
      {"names", many_names},
      {"sparse", sparse},
      {"a chain of nodes", chain_of_nodes},
      {"nodes of many surfaces", nodes_of_many_surfaces},
  };
}

std::vector<Family> obj_families() {
  return {
      {"stars", stars, 30},
      {"one face", one_face},
      {"faces", [](int n) { return MadeFile{lines("f 1 2 3\n", n)}; }},
      {"empty polylines", [](int n) { return MadeFile{lines("l\n", n)}; }},
      {"coordinates", [](int n) { return MadeFile{lines("vt 0 0\n", n)}; }},
      {"continued", [](int n) { return MadeFile{lines("\\\n", n)}; }},
      {"comments", [](int n) { return MadeFile{lines("#\n", n)}; }},
      {"materials", [](int n) { return numbered_lines("usemtl ", n); }},
      {"a polyline", [](int n) { return MadeFile{lines("", 0) + 'l' + repeated(" 1", n)}; }},
  };
}

}  // namespace unwrapd::asset::test
