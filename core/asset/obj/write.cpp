// The text is copied statement by statement, without its vt lines; the new ones precede the first
// face.
#include "core/asset/base/as_size.hpp"
#include "core/asset/obj/polygons.hpp"
#include "core/asset/obj/text.hpp"
#include "core/base/cancel.hpp"

namespace unwrapd::asset::obj {
namespace {

class ObjWriter {
 public:
  ObjWriter(const Obj& obj, const UnwrappedSurface& unwrapped)
      : obj_(obj), unwrapped_(unwrapped), pace_(obj.stop) {}

  std::string write() {
    out_.reserve(obj_.text.size() + unwrapped_.uv.size() * 42 + obj_.corners.size() * 8);
    for (const Element& element : obj_.elements) {
      pace_.add(1 + 3 * element.corner_count);
      keep_until(element.begin);
      if (element.face_count() > 0 && !has_texcoords_) append_all_texcoords();
      write_element(element);
      at_ = element.end;
    }
    keep_until(obj_.text.size());
    return std::move(out_);
  }

 private:
  /// Copies the text up to `end`, without its vt statements.
  void keep_until(std::size_t end) {
    const std::string_view text = obj_.text;
    for (; vt_ < obj_.texcoord_lines.size() && obj_.texcoord_lines[vt_].first < end; ++vt_) {
      pace_.add(1);
      out_ += text.substr(at_, obj_.texcoord_lines[vt_].first - at_);
      at_ = obj_.texcoord_lines[vt_].second;
    }
    out_ += text.substr(at_, end - at_);
    at_ = end;
  }

  /// Called before the first face, since readers need the coordinates first.
  void append_all_texcoords() {
    for (const Vec2& uv : unwrapped_.uv) {
      pace_.add(4);
      append_vt(out_, uv);
    }
    has_texcoords_ = true;
  }

  void write_element(const Element& element) {
    if (element.face_count() == 0) return write_without_texcoords(element);
    if (polygon_fate(obj_, element, unwrapped_, texcoords_) == PolygonFate::kept) {
      out_ += 'f';
      for (std::size_t i = 0; i < element.corner_count; ++i)
        append_corner(element, i, texcoords_[i]);
    } else {
      write_triangles(element);
    }
  }

  void write_without_texcoords(const Element& element) {
    out_ += element.keyword;
    for (std::size_t i = 0; i < element.corner_count; ++i) append_corner(element, i, kUnset);
  }

  void write_triangles(const Element& element) {
    for (std::size_t t = element.first_face; t < element.first_face + element.face_count(); ++t) {
      out_ += t == element.first_face ? "f" : "\nf";
      for (std::size_t k = 0; k < 3; ++k)
        append_corner(element, as_size(obj_.face_corners[t][k]), unwrapped_.faces[t][k]);
    }
  }

  void append_corner(const Element& element, std::size_t corner, Index texcoord) {
    const Corner& c = obj_.corners[element.first_corner + corner];
    append_indices(out_, c.vertex, texcoord, c.normal);
  }

  const Obj& obj_;
  const UnwrappedSurface& unwrapped_;
  Pace pace_;
  std::string out_;
  std::size_t at_ = 0;
  std::size_t vt_ = 0;
  bool has_texcoords_ = false;
  std::vector<Index> texcoords_;
};

}  // namespace

std::string write_obj(const Obj& obj, const UnwrappedSurface& unwrapped) {
  return ObjWriter(obj, unwrapped).write();
}

}  // namespace unwrapd::asset::obj
