#include "core/asset/other_formats.hpp"

#include <array>
#include <string>

#include "core/base/error.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::string_view kByBlender =
    "convert it to glTF: import it in Blender, then File > Export > glTF 2.0";

struct Refusal {
  std::string_view mark;
  std::string_view name;
  std::string_view advice;
};

constexpr std::string_view kFbx =
    "convert it to glTF: FBX2glTF --binary --input FILE, or File > Import and Export in Blender";
constexpr std::string_view kUsd =
    "convert it to glTF: usd2gltf -i FILE -o FILE.glb, or File > Import and Export in Blender";
constexpr std::string_view kBlend = "in Blender, use File > Export > glTF 2.0";
constexpr std::string_view kSaveAsUtf8 = "save the file as UTF-8";

/// Marks at the start of a file.
constexpr std::array<Refusal, 13> kStarts = {
    {{"Kaydara FBX", "FBX", kFbx},
     {"; FBX", "FBX", kFbx},
     {"PXR-USDC", "USD", kUsd},
     {"#usda", "USD", kUsd},
     {"BLENDER", "a BLEND file", kBlend},
     {"\x28\xb5\x2f\xfd", "a file compressed by zstd, such as a BLEND file,", kBlend},
     {"DRACO", "a bare Draco file", "wrap it into a glTF"},
     {"\x1f\x8b", "a gzip file", "send it unpacked"},
     {"#VRML", "VRML", kByBlender},
     {"#X3D", "X3D", kByBlender},
     {"ISO-10303-21", "STEP", "export a mesh from the CAD program, as glTF, STL or OBJ"},
     {"\xff\xfe", "UTF-16 text", kSaveAsUtf8},
     {"\xfe\xff", "UTF-16 text", kSaveAsUtf8}}};

/// Elements of XML near the start of a file.
constexpr std::array<Refusal, 4> kElements = {{{"<COLLADA", "Collada", kByBlender},
                                               {"<X3D", "X3D", kByBlender},
                                               {"<amf", "AMF", kByBlender},
                                               {"<model", "3MF", kByBlender}}};

/// Names of files in a zip archive, which has them at its start and at its end.
constexpr std::array<Refusal, 4> kZipNames = {
    {{"3D/3dmodel.model", "3MF", kByBlender},
     {".usdc", "USDZ", kUsd},
     {".usda", "USDZ", kUsd},
     {"", "a zip archive without an asset",
      "put one glTF, OBJ, STL, PLY or OFF into it, outside of other archives"}}};

constexpr std::size_t kNear = 4096;  // bytes

[[noreturn]] void refuse_format(const Refusal& refusal) {
  throw Error(ErrorCode::unknown_format,
              std::string(refusal.name) + " is not accepted; " + std::string(refusal.advice));
}

bool has_mark(std::string_view text, std::string_view mark) {
  return text.find(mark) != std::string_view::npos;
}

}  // namespace

void refuse_other_formats(std::string_view file) {
  for (const Refusal& refusal : kStarts)
    if (file.starts_with(refusal.mark)) refuse_format(refusal);
  const std::string_view start = file.substr(0, kNear);
  const std::string_view end = file.substr(file.size() - start.size());
  const std::size_t first = start.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first != std::string_view::npos && start[first] == '<')
    for (const Refusal& refusal : kElements)
      if (has_mark(start, refusal.mark)) refuse_format(refusal);
  if (file.starts_with("PK\x03\x04"))
    for (const Refusal& refusal : kZipNames)
      if (has_mark(start, refusal.mark) || has_mark(end, refusal.mark)) refuse_format(refusal);
}

}  // namespace unwrapd::asset
