#include "core/asset/recognise.hpp"

#include <algorithm>
#include <array>

#include "core/base/error.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::string_view kMarkOfUtf8 = "\xef\xbb\xbf";
constexpr std::string_view kSpaces = " \t\r\n";
constexpr std::size_t kMaxScanned = 1 << 16;  // bytes of an OBJ that may go before its first vertex

struct Refusal {
  std::string_view magic;
  std::string_view message;
};

constexpr std::array<Refusal, 6> kRefusals = {
    {{"DRACO", "a bare Draco file is not accepted; wrap it into a glTF"},
     {"\x1f\x8b", "a gzip file is not accepted; send it unpacked"},
     {"PK\x03\x04", "a zip archive is not accepted; send the glTF or OBJ in it"},
     {"Kaydara FBX", "FBX is not accepted; convert it to glTF"},
     {"ply\n", "PLY is not accepted; convert it to glTF or OBJ"},
     {"solid ", "STL is not accepted; convert it to glTF or OBJ"}}};

/// A line that begins a vertex, after any number of other lines of text.
bool looks_like_obj(std::string_view file) {
  const std::string_view head = file.substr(0, kMaxScanned);
  if (head.find('\0') != std::string_view::npos) return false;
  for (std::size_t at = 0; at < head.size();) {
    const std::string_view line = head.substr(at, head.find_first_of("\r\n", at) - at);
    const std::size_t word = std::min(line.find_first_not_of(kSpaces), line.size());
    if (line.substr(word).starts_with("v ") || line.substr(word).starts_with("v\t")) return true;
    at += line.size() + 1;
  }
  return false;
}

}  // namespace

Format recognise(std::string_view file) {
  if (file.starts_with("glTF")) return Format::glb;
  for (const Refusal& refusal : kRefusals)
    if (file.starts_with(refusal.magic))
      throw Error(ErrorCode::unknown_format, std::string(refusal.message));
  std::string_view text = file;
  if (text.starts_with(kMarkOfUtf8)) text.remove_prefix(kMarkOfUtf8.size());
  const std::size_t first = text.find_first_not_of(kSpaces);
  if (first != std::string_view::npos && text[first] == '{') return Format::gltf;
  if (looks_like_obj(text)) return Format::obj;
  throw Error(ErrorCode::unknown_format,
              "the file is neither GLB, glTF nor OBJ; send one of these");
}

}  // namespace unwrapd::asset
