#include <charconv>

#include "core/asset/base/no_uv.hpp"
#include "core/asset/obj/obj.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::obj {
namespace {

/// The two numbers of a vt statement; NaN if they cannot be read.
Vec2 read_vt(std::string_view line) {
  Vec2 uv = kNoUv;
  std::size_t at = line.find("vt") + 2;
  for (int k = 0; k < 2; ++k) {
    at = line.find_first_not_of(" \t", at);
    if (at == std::string_view::npos) break;
    if (line[at] == '+') ++at;
    const auto [end, error] = std::from_chars(line.data() + at, line.data() + line.size(), uv[k]);
    if (error != std::errc()) return kNoUv;
    at = static_cast<std::size_t>(end - line.data());
  }
  return uv.allFinite() ? uv : kNoUv;
}

}  // namespace

std::vector<Vec2> texcoords_of(const Obj& obj) {
  std::vector<Vec2> vt;
  vt.reserve(obj.texcoord_lines.size());
  for (const auto& [begin, end] : obj.texcoord_lines) {
    check_cancelled_every(vt.size(), obj.stop);
    vt.push_back(read_vt(std::string_view(obj.text).substr(begin, end - begin)));
  }
  return vt;
}

}  // namespace unwrapd::asset::obj
