#include "core/asset/recognise.hpp"

#include <algorithm>
#include <array>

#include "core/asset/base/pace.hpp"
#include "core/asset/base/words.hpp"
#include "core/asset/mesh_files/mesh_file.hpp"
#include "core/asset/mesh_files/text_reader.hpp"
#include "core/asset/other_formats.hpp"
#include "core/base/error.hpp"
#include "core/base/lower_case.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::string_view kSpaces = " \t\r\n";
constexpr std::array<std::string_view, 6> kOtherGeometry = {"vt", "vn", "vp", "f", "l", "p"};
constexpr std::string_view kStartsOfNumbers = "+-.0123456789";
constexpr std::size_t kBlock = 1 << 16;
constexpr std::size_t kMaxStatements =
    kBlock;  // bytes of other statements that may precede geometry

/// The position after spaces and empty lines; the text's size at its end.
std::size_t skip_spaces(std::string_view text, std::size_t at, Pace& pace) {
  while (at < text.size()) {
    const std::size_t found = text.substr(at, kBlock).find_first_not_of(kSpaces);
    pace.add(std::min(found, kBlock) / 16);
    if (found != std::string_view::npos) return at + found;
    at += kBlock;
  }
  return text.size();
}

/// Whether a line is a vertex, or another statement of geometry with its indices or numbers.
bool is_geometry(std::string_view line) {
  Words words(line);
  const std::string_view keyword = words.next();
  if (keyword == "v") return line.size() > keyword.size();
  const std::string_view value = words.next();
  return std::ranges::find(kOtherGeometry, keyword) != kOtherGeometry.end() && !value.empty() &&
         kStartsOfNumbers.find(value.front()) != std::string_view::npos;
}

/// Whether a line of geometry follows comments, empty lines and some other statements.
bool looks_like_obj(std::string_view file, Pace& pace) {
  if (file.substr(0, kBlock).find('\0') != std::string_view::npos) return false;
  std::size_t statements = 0;
  for (std::size_t at = skip_spaces(file, 0, pace);
       at < file.size() && statements < kMaxStatements;) {
    const std::string_view line = file.substr(at, file.find_first_of("\r\n", at) - at);
    pace.add(1 + line.size() / 16);
    if (line.front() != '#') {
      if (is_geometry(line.substr(0, kBlock))) return true;
      statements += line.size();
    }
    at = skip_spaces(file, at + line.size(), pace);
  }
  return false;
}

/// Whether a text starts with "solid" and a space, in any case.
bool starts_with_solid(std::string_view text) {
  constexpr std::string_view kSolid = "solid";
  return text.size() > kSolid.size() &&
         std::ranges::equal(text.substr(0, kSolid.size()), kSolid, {}, lower_letter) &&
         kSpaces.find(text[kSolid.size()]) != std::string_view::npos;
}

}  // namespace

Format recognise(std::string_view file, const std::stop_token& stop) {
  if (file.starts_with("glTF")) return Format::glb;
  if (file.starts_with("ply\n") || file.starts_with("ply\r")) return Format::ply;
  if (mesh_files::is_binary_stl(file)) return Format::stl;
  refuse_other_formats(file);
  const std::string_view text = file.substr(mesh_files::start_of_text(file));
  Pace pace(stop);
  const std::string_view words = text.substr(skip_spaces(text, 0, pace));
  if (words.starts_with('{')) return Format::gltf;
  if (starts_with_solid(words)) return Format::stl;
  if (mesh_files::is_off(file, stop)) return Format::off;
  if (looks_like_obj(text, pace)) return Format::obj;
  throw Error(ErrorCode::unknown_format,
              "the file is neither GLB, glTF, OBJ, STL, PLY nor OFF; send one of these");
}

}  // namespace unwrapd::asset
