#include "core/asset/base/input.hpp"

namespace unwrapd::asset {

std::string_view format_name(Format format) {
  switch (format) {
    case Format::glb:
      return "glb";
    case Format::gltf:
      return "gltf";
    case Format::obj:
      return "obj";
    case Format::stl:
      return "stl";
    case Format::ply:
      return "ply";
    case Format::off:
      return "off";
  }
  return "glb";
}

Format usual_output(Format input) {
  return input == Format::gltf || input == Format::obj ? input : Format::glb;
}

}  // namespace unwrapd::asset
