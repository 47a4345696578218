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
constexpr std::array<std::string_view, 15> kForeign = {"zip",  "fbx",  "dae",  "usd", "usda",
                                                       "usdc", "usdz", "3mf",  "3ds", "blend",
                                                       "png",  "jpg",  "jpeg", "svg", "html"};

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

std::string extension_of(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return extension.empty() ? extension : extension.substr(1);
}

bool is_mesh_name(const fs::path& path) {
  const std::string extension = extension_of(path);
  return is_among(kWritten, extension) || is_among(kOnlyRead, extension) || extension == "zip";
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

std::string usual_output(const fs::path& file) {
  const std::string extension = extension_of(file);
  const bool tells = is_among(kWritten, extension) || is_among(kOnlyRead, extension);
  return tells || is_stream(file) ? "auto" : "glb";
}

void check_ending(const std::string& flag, const fs::path& path,
                  std::span<const std::string_view> known) {
  const std::string extension = extension_of(path);
  if (extension.empty() || is_among(known, extension)) return;
  std::string names;
  for (const std::string_view name : known)
    names += (names.empty() ? "." : " or .") + std::string(name);
  throw Failure(ExitCode::usage,
                flag + ": ." + extension + " is not written; name a " + names + ".");
}

bool is_png(const fs::path& path) { return extension_of(path) == "png"; }

fs::path default_out(const fs::path& given, const std::string& output) {
  if (is_stream(given)) return "-";
  const fs::path file = local_name(given);
  if (is_address(given) && !is_mesh_name(file))
    throw Failure(ExitCode::usage, "The address names no mesh file; name the result by --out.");
  fs::path out = file;
  const bool keep = output.empty() || output == "auto";
  std::string extension = keep ? file.extension().string() : "." + output;
  if (keep && !is_among(kWritten, extension_of(file))) extension = ".glb";
  out.replace_filename(file.stem().string() + ".uv" + extension);
  return out;
}

}  // namespace unwrapd::client
