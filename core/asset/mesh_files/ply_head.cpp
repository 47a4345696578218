#include <algorithm>
#include <array>
#include <limits>

#include "core/asset/base/words.hpp"
#include "core/asset/mesh_files/ply.hpp"

namespace unwrapd::asset::mesh_files {
namespace {

constexpr std::size_t kMaxHead = 1 << 16;  // bytes

struct TypeName {
  std::string_view name;
  PlyType type;
};

constexpr std::array<TypeName, 16> kTypes = {{{"char", PlyType::i8},
                                              {"int8", PlyType::i8},
                                              {"uchar", PlyType::u8},
                                              {"uint8", PlyType::u8},
                                              {"short", PlyType::i16},
                                              {"int16", PlyType::i16},
                                              {"ushort", PlyType::u16},
                                              {"uint16", PlyType::u16},
                                              {"int", PlyType::i32},
                                              {"int32", PlyType::i32},
                                              {"uint", PlyType::u32},
                                              {"uint32", PlyType::u32},
                                              {"float", PlyType::f32},
                                              {"float32", PlyType::f32},
                                              {"double", PlyType::f64},
                                              {"float64", PlyType::f64}}};

bool is_printable(std::string_view word) {
  return std::ranges::all_of(word, [](char c) { return c > ' ' && c < 0x7f; });
}

class HeadReader {
 public:
  HeadReader(std::string_view file, const std::stop_token& stop)
      : text_(file.substr(0, kMaxHead)), reader_(text_, 0, stop) {}

  PlyHead read() {
    reader_.next();  // "ply"
    line_end_ = text_.substr(3).starts_with("\r\n") ? 2 : 1;
    for (std::string_view word = keyword(); word != "end_header"; word = keyword()) read_line(word);
    if (!has_format_) reader_.refuse("the head has no line \"format\"");
    head_.size = text_.size() - reader_.bytes_left() + line_end_;
    if (head_.size > text_.size()) head_.size = text_.size();
    return std::move(head_);
  }

 private:
  std::string_view keyword() {
    const std::string_view word = reader_.next();
    if (word.empty()) reader_.refuse("the head has no line \"end_header\" within 64 KiB");
    return word;
  }

  void read_line(std::string_view word) {
    if (word == "format") {
      read_format();
    } else if (word == "element") {
      head_.elements.push_back({.name = name(), .count = count(), .properties = {}});
    } else if (word == "property") {
      read_property();
    } else if (word != "comment" && word != "obj_info") {
      reader_.refuse("\"" + std::string(word.substr(0, kShownBytes)) + "\" is no line of a head");
    }
    reader_.skip_line();
  }

  void read_format() {
    const std::string_view word = reader_.next();
    has_format_ = true;
    if (word == "ascii") return;
    if (word != "binary_little_endian" && word != "binary_big_endian")
      reader_.refuse("the format is not ascii, binary_little_endian or binary_big_endian");
    head_.encoding =
        word == "binary_big_endian" ? PlyEncoding::big_endian : PlyEncoding::little_endian;
  }

  std::string name() {
    const std::string_view word = reader_.next();
    if (word.empty() || !is_printable(word)) reader_.refuse("a name is expected");
    return std::string(word.substr(0, kShownBytes));
  }

  std::int64_t count() { return reader_.whole(0, std::numeric_limits<std::int64_t>::max()); }

  PlyType type(std::string_view word) {
    const auto found = std::ranges::find(kTypes, word, &TypeName::name);
    if (found == kTypes.end()) reader_.refuse("a type of numbers is expected");
    return found->type;
  }

  void read_property() {
    if (head_.elements.empty()) reader_.refuse("a property stands before the first element");
    PlyProperty property;
    std::string_view word = reader_.next();
    if (word == "list") {
      property.count_type = type(reader_.next());
      word = reader_.next();
    }
    property.type = type(word);
    property.name = name();
    head_.elements.back().properties.push_back(std::move(property));
  }

  std::string_view text_;
  TextReader reader_;
  PlyHead head_;
  std::size_t line_end_ = 1;  ///< bytes
  bool has_format_ = false;
};

}  // namespace

PlyHead read_ply_head(std::string_view file, const std::stop_token& stop) {
  return HeadReader(file, stop).read();
}

}  // namespace unwrapd::asset::mesh_files
