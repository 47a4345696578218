// OFF, as Geomview defines it: counts, then one line for each vertex and each face. Whatever
// follows the position on a line is a normal, a colour or a texture coordinate; what follows the
// corners of a face is its colour.
#include <limits>

#include "core/asset/mesh_files/mesh_file.hpp"
#include "core/asset/mesh_files/text_reader.hpp"
#include "core/base/error.hpp"

namespace unwrapd::asset::mesh_files {
namespace {

constexpr char kComment = '#';

/// The keyword: "OFF" with the prefixes ST, C, N, 4 and n, in this order.
struct Keyword {
  std::size_t size = 0;  ///< bytes, 0 if the text starts with none
  bool has_texcoords = false, has_colours = false, has_normals = false;
  bool is_of_space = true;  ///< of three dimensions
};

Keyword keyword_of(std::string_view text) {
  Keyword keyword;
  std::string_view rest = text;
  const auto take = [&rest](std::string_view prefix) {
    const bool found = rest.starts_with(prefix);
    if (found) rest.remove_prefix(prefix.size());
    return found;
  };
  keyword.has_texcoords = take("ST");
  keyword.has_colours = take("C");
  keyword.has_normals = take("N");
  keyword.is_of_space = !take("4");
  keyword.is_of_space &= !take("n");
  if (take("OFF")) keyword.size = text.size() - rest.size();
  return keyword;
}

/// The first word, which may hold more than the keyword ("OFF8").
struct FirstWord {
  Keyword keyword;
  std::size_t begin = 0;  ///< byte of the file
};

FirstWord first_word_of(std::string_view file, const std::stop_token& stop) {
  TextReader reader(file, start_of_text(file), stop, kComment);
  const std::string_view word = reader.next();
  return {keyword_of(word), file.size() - reader.bytes_left() - word.size()};
}

class OffReader {
 public:
  OffReader(const Input& input, const ReadLimits& limits, Surface& surface)
      : OffReader(input, first_word_of(input.document, input.stop), limits, surface) {}

  MeshFile read() {
    if (!keyword_.is_of_space) reader_.refuse("the vertices are not of three dimensions");
    const std::int64_t vertices = read_count(kVertexBytes), faces = read_count(kFaceBytes);
    reader_.skip_line();  // with the number of edges, which nobody needs
    check_vertex_count(vertices, limits_);
    read_vertices(vertices);
    read_faces(faces, vertices);
    if (keyword_.has_texcoords) file_.dropped.emplace_back("texture coordinates");
    if (has_other_colours_) file_.dropped.emplace_back("vertex colours");
    if (has_face_colours_) file_.dropped.emplace_back("face colours");
    add_faces(polygons_, limits_, surface_, file_);
    return std::move(file_);
  }

 private:
  OffReader(const Input& input, const FirstWord& first, const ReadLimits& limits, Surface& surface)
      : keyword_(first.keyword),
        reader_(input.document, first.begin + first.keyword.size, input.stop, kComment),
        limits_(limits),
        surface_(surface) {
    file_.stop = input.stop;
  }

  static constexpr std::int64_t kVertexBytes = 6, kFaceBytes = 2;  // at least: "0 0 0\n", "0\n"

  /// A number of elements, each of at least so many bytes.
  std::int64_t read_count(std::int64_t bytes) {
    const std::int64_t count = reader_.whole(0, std::numeric_limits<std::int64_t>::max());
    if (count > (static_cast<std::int64_t>(reader_.bytes_left()) + 1) / bytes)
      reader_.refuse("the file is too short for " + std::to_string(count) + " elements");
    return count;
  }

  Vec3 read_vec3() {
    const double x = reader_.number(), y = reader_.number();
    return {x, y, reader_.number()};
  }

  void read_vertices(std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
      surface_.mesh.positions.push_back(read_vec3());
      if (!is_position(surface_.mesh.positions.back())) refuse_position(reader_.place());
      if (keyword_.has_normals) file_.normals.push_back(read_vec3());
      read_colour();
    }
    normalize_colours(file_.colours);
  }

  /// Three or four numbers after the position and the normal. Texture coordinates would follow the
  /// colour, in lines of which nobody can tell whether it has an alpha; one number names a colour
  /// of a list that the file does not hold.
  void read_colour() {
    const std::string_view rest = reader_.rest_of_line();
    std::optional<Colour> colour;
    if (!keyword_.has_texcoords) colour = colour_in(Words(rest));
    add_colour(colour, surface_.mesh.positions.size(), file_.colours);
    const bool may_be_colour = !keyword_.has_texcoords || keyword_.has_colours;
    has_other_colours_ |= may_be_colour && !colour && !Words(rest).next().empty();
  }

  void read_faces(std::int64_t count, std::int64_t vertices) {
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t corners =
          reader_.whole(0, (static_cast<std::int64_t>(reader_.bytes_left()) + 1) / 2);
      for (std::int64_t k = 0; k < corners; ++k)
        polygons_.corners.push_back(static_cast<Index>(reader_.whole(0, vertices - 1)));
      polygons_.ends.push_back(polygons_.corners.size());
      has_face_colours_ |= reader_.skip_line();
    }
  }

  Keyword keyword_;
  TextReader reader_;
  const ReadLimits& limits_;
  Surface& surface_;
  MeshFile file_;
  PolygonList polygons_;
  bool has_other_colours_ = false, has_face_colours_ = false;  ///< on any line
};

}  // namespace

bool is_off(std::string_view file, const std::stop_token& stop) {
  return first_word_of(file, stop).keyword.size > 0;
}

MeshFile read_off(const Input& input, const ReadLimits& limits, Surface& surface) {
  return OffReader(input, limits, surface).read();
}

}  // namespace unwrapd::asset::mesh_files
