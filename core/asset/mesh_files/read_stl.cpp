// STL lists triangles by the positions of their corners: 50 bytes each after a head of 84, or text.
// Neighbours are found by equal positions.
#include <array>

#include "core/asset/base/as_size.hpp"
#include "core/asset/base/bytes.hpp"
#include "core/asset/mesh_files/mesh_file.hpp"
#include "core/asset/mesh_files/text_reader.hpp"
#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/base/lower_case.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd::asset::mesh_files {
namespace {

constexpr std::size_t kCountAt = 80;   // byte of the number of triangles
constexpr std::size_t kHead = 84;      // bytes
constexpr std::size_t kTriangle = 50;  // bytes: a normal, three corners, two bytes of attributes
constexpr std::size_t kNormal = 12;    // bytes
constexpr std::size_t kExtrasAt = 48;  // byte of a triangle at which its attributes are

bool has_zero_byte(std::string_view head) { return head.find('\0') != std::string_view::npos; }

std::uint32_t announced(std::string_view file) { return load<std::uint32_t>(&file[kCountAt]); }

Vec3 vec3_at(const char* bytes) {
  return {load<float>(bytes), load<float>(bytes + 4), load<float>(bytes + 8)};
}

/// The corners of all triangles, three after three.
using Corners = std::vector<Vec3>;

class BinaryStl {
 public:
  BinaryStl(const Input& input, const ReadLimits& limits, MeshFile& file)
      : bytes_(input.document), stop_(input.stop), limits_(limits), file_(file) {}

  Corners read() {
    if (!is_binary_stl(bytes_))
      refuse_mesh(bytes_.size() < kHead
                      ? "the file ends within the head of a binary STL"
                      : "the head announces " + std::to_string(announced(bytes_)) +
                            " triangles, whose length is not that of the file",
                  "byte " + std::to_string(kCountAt));
    const std::uint32_t count = announced(bytes_);
    check_face_count(count, limits_);
    Corners corners;
    corners.reserve(std::size_t{3} * count);
    for (std::size_t t = 0; t < count; ++t) {
      check_cancelled_every(t, stop_);
      read_triangle(kHead + kTriangle * t, corners);
    }
    if (has_extras_) file_.dropped.emplace_back("attribute bytes of its triangles");
    return corners;
  }

 private:
  void read_triangle(std::size_t at, Corners& corners) {
    for (std::size_t k = 1; k <= 3; ++k) {
      corners.push_back(vec3_at(&bytes_[at + k * kNormal]));
      if (!is_position(corners.back())) refuse_position("byte " + std::to_string(at + k * kNormal));
    }
    has_extras_ |= load<std::uint16_t>(&bytes_[at + kExtrasAt]) != 0;
  }

  std::string_view bytes_;
  std::stop_token stop_;
  const ReadLimits& limits_;
  MeshFile& file_;
  bool has_extras_ = false;
};

/// Keywords may have any case. Whatever follows "solid" and "endsolid" on their lines is a name.
class TextStl {
 public:
  TextStl(const Input& input, const ReadLimits& limits)
      : reader_(input.document, start_of_text(input.document), input.stop), limits_(limits) {}

  Corners read() {
    bool is_open = false;
    for (std::string word = next_word(); !word.empty(); word = next_word()) {
      if (word == "facet" && is_open) {
        read_facet();
      } else if (word == (is_open ? "endsolid" : "solid")) {
        is_open = !is_open;
        reader_.skip_line();
      } else {
        reader_.refuse("\"" + word.substr(0, kShownBytes) +
                       "\" stands where a facet or a solid is expected");
      }
    }
    if (is_open) reader_.refuse("the file ends before \"endsolid\"");
    return std::move(corners_);
  }

 private:
  std::string next_word() { return lower_case(reader_.next()); }

  void expect(std::string_view keyword) {
    if (next_word() != keyword) reader_.refuse("\"" + std::string(keyword) + "\" is expected");
  }

  /// The normal follows from the corners, so its three words may be anything: exporters write nan.
  void read_facet() {
    expect("normal");
    for (int k = 0; k < 3; ++k) reader_.next();
    expect("outer");
    expect("loop");
    for (int k = 0; k < 3; ++k) {
      expect("vertex");
      const double x = reader_.number(), y = reader_.number();
      corners_.emplace_back(x, y, reader_.number());
      if (!is_position(corners_.back())) refuse_position(reader_.place());
    }
    check_face_count(static_cast<std::int64_t>(corners_.size() / 3), limits_);
    expect("endloop");
    expect("endfacet");
  }

  TextReader reader_;
  const ReadLimits& limits_;
  Corners corners_;
};

/// Makes one vertex of all corners at a position.
void join(const Corners& corners, const ReadLimits& limits, const std::stop_token& stop,
          TriMesh& mesh) {
  std::vector<Index> number = weld(corners, stop);  // of the first corner there, then of the vertex
  for (std::size_t i = 0; i < corners.size(); ++i) {
    check_cancelled_every(i, stop);
    if (as_size(number[i]) != i) {
      number[i] = number[as_size(number[i])];
      continue;
    }
    number[i] = mesh.vertex_count();
    check_vertex_count(std::int64_t{number[i]} + 1, limits);
    mesh.positions.push_back(corners[i]);
  }
  mesh.faces.reserve(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    mesh.faces.push_back({number[i], number[i + 1], number[i + 2]});
}

}  // namespace

bool is_binary_stl(std::string_view file) {
  return file.size() >= kHead && (file.size() - kHead) / kTriangle == announced(file) &&
         (file.size() - kHead) % kTriangle == 0;
}

MeshFile read_stl(const Input& input, const ReadLimits& limits, Surface& surface) {
  MeshFile file;
  file.stop = input.stop;
  const bool is_binary =
      is_binary_stl(input.document) || has_zero_byte(input.document.substr(0, kHead));
  const Corners corners =
      is_binary ? BinaryStl(input, limits, file).read() : TextStl(input, limits).read();
  if (corners.empty())
    throw Error(ErrorCode::no_triangles, "the mesh has no faces; send one with at least one");
  join(corners, limits, input.stop, surface.mesh);
  surface.part.assign(surface.mesh.faces.size(), 0);
  return file;
}

}  // namespace unwrapd::asset::mesh_files
