#pragma once
// What is fuzzed. A target takes any bytes at all: it answers or throws Error, which its runner
// swallows; anything else (a crash, a sanitizer's finding, another exception, a broken promise) is
// a finding.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::fuzz {

struct Target {
  std::string_view name;
  void (*run)(std::string_view bytes);
  std::vector<std::string> (*seeds)();  ///< good inputs to begin with, made by our own writers
};

std::span<const Target> asset_targets();   ///< gltf, obj, draco, meshopt, image
std::span<const Target> api_targets();     ///< options, query, constraints
std::span<const Target> http_targets();    ///< head, http, multipart, reference, parking
std::span<const Target> worker_targets();  ///< frames, uvs
Target parking_target();
Target image_target();

/// Ends the program, saying what was promised, when it does not hold.
void promise(bool holds, const char* what);

/// A wavy grid of 2 n^2 faces as an OBJ, with texture coordinates and normals.
std::string grid_obj(int n);

}  // namespace unwrapd::fuzz
