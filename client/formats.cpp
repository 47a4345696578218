#include "client/formats.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "client/failure.hpp"
#include "client/files.hpp"
#include "core/base/lower_case.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kWritten = {"glb", "gltf", "obj"};
constexpr std::array<std::string_view, 3> kOnlyRead = {"stl", "ply", "off"};
constexpr std::array<std::string_view, 10> kForeign = {"zip",  "fbx",  "dae", "usd", "usda",
                                                       "usdc", "usdz", "3mf", "3ds", "blend"};

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// The extension in lower case, without its dot.
std::string extension_of(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return extension.empty() ? extension : extension.substr(1);
}

}  // namespace

bool is_mesh_name(const fs::path& path) {
  const std::string extension = extension_of(path);
  return is_among(kWritten, extension) || is_among(kOnlyRead, extension) || is_zip(path);
}

std::string format_of(const fs::path& path) {
  const std::string extension = extension_of(path);
  if (is_among(kWritten, extension)) return extension;
  if (is_among(kOnlyRead, extension) || is_among(kForeign, extension))
    throw Failure(ExitCode::usage,
                  "--out: ." + extension + " is not written" +
                      (extension == "stl" ? ", because STL has no place for UVs" : "") +
                      "; name a .glb, .gltf or .obj.");
  return "auto";
}

bool is_zip(const fs::path& path) { return extension_of(path) == "zip"; }

fs::path default_out(const fs::path& given, const std::string& output) {
  if (is_stream(given)) return "-";
  const fs::path file = local_name(given);
  if (is_address(given) && !is_mesh_name(file))
    throw Failure(ExitCode::usage, "The address names no mesh file; name the result by --out.");
  fs::path out = file;
  const bool keep = output.empty() || output == "auto";
  std::string extension = keep ? file.extension().string() : "." + output;
  if (keep && (is_among(kOnlyRead, extension_of(file)) || is_zip(file))) extension = ".glb";
  out.replace_filename(file.stem().string() + ".uv" + extension);
  return out;
}

}  // namespace unwrapd::client
