#include "core/asset/obj/text.hpp"

#include <array>
#include <charconv>

namespace unwrapd::asset::obj {
namespace {

template <class Number>
void append_number(std::string& out, Number value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  out.append(text.data(), result.ptr);
}

template <class Vector>
void append_three(std::string& out, const Vector& values) {
  for (int k = 0; k < 3; ++k) {
    out += ' ';
    append_number(out, values[k]);
  }
}

}  // namespace

void append_indices(std::string& out, Index vertex, Index texcoord, Index normal) {
  out += ' ';
  append_number(out, vertex + 1);
  if (texcoord < 0 && normal < 0) return;
  out += '/';
  if (texcoord >= 0) append_number(out, texcoord + 1);
  if (normal < 0) return;
  out += '/';
  append_number(out, normal + 1);
}

/// UVs have the precision of a float, as in every other format. The text is that of the value as a
/// double, since a reader of doubles gets another value from the shortest text of a float, which
/// flips triangles a few steps high.
void append_vt(std::string& out, const Vec2& uv) {
  out += "vt ";
  append_number(out, static_cast<double>(static_cast<float>(uv.x())));
  out += ' ';
  append_number(out, static_cast<double>(static_cast<float>(uv.y())));
  out += '\n';
}

void append_vn(std::string& out, const Vec3& normal) {
  out += "vn";
  append_three(out, normal);
  out += '\n';
}

void append_v(std::string& out, const Vec3& position, const Colour* colour) {
  out += 'v';
  append_three(out, position);
  if (colour != nullptr) append_three(out, as_shown(*colour));
  out += '\n';
}

}  // namespace unwrapd::asset::obj
