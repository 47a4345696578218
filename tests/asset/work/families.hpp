#pragma once
// Families of small documents that grow in one respect each: what they cost must grow as their
// bytes do.

#include <functional>
#include <string>
#include <vector>

#include "core/types/asset_options.hpp"

namespace unwrapd::asset::test {

struct MadeFile {
  std::string bytes;
  AssetOptions options = {};
};

struct Family {
  std::string name;
  std::function<MadeFile(int)> make;
  int size = 1000;  ///< of the smaller of two
};

std::vector<Family> gltf_families();
std::vector<Family> obj_families();

}  // namespace unwrapd::asset::test
