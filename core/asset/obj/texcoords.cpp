#include "core/asset/base/no_uv.hpp"
#include "core/asset/base/words.hpp"
#include "core/asset/obj/obj.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::obj {
namespace {

/// The two numbers of a vt statement, of which the second may be left out; kNoUv if they cannot be
/// read.
Vec2 read_vt(std::string_view statement) {
  Words words(statement);
  words.next();  // "vt"
  const std::optional<double> u = number_in(words.next());
  const std::string_view second = words.next();
  const std::optional<double> v = second.empty() ? std::optional(0.0) : number_in(second);
  if (!u || !v) return kNoUv;
  const Vec2 uv(*u, *v);
  return uv.allFinite() ? uv : kNoUv;
}

}  // namespace

std::vector<Vec2> texcoords_of(const Obj& obj) {
  std::vector<Vec2> vt;
  vt.reserve(obj.texcoord_lines.size());
  for (const auto& [line, next] : obj.texcoord_lines) {
    check_cancelled_every(vt.size(), obj.stop);
    const Statement own = statement_at(obj.text, line);
    vt.push_back(read_vt(std::string_view(obj.text).substr(own.begin, own.end - own.begin)));
  }
  return vt;
}

}  // namespace unwrapd::asset::obj
