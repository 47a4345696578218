#pragma once
// The head of a PLY, and its values. (Turk, The PLY polygon file format, 1994.)

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/mesh_files/text_reader.hpp"

namespace unwrapd::asset::mesh_files {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class PlyEncoding { text, little_endian, big_endian };

struct PlyProperty {
  std::string name;
  std::optional<PlyType> count_type;  ///< of a list
  PlyType type = PlyType::f32;
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHead {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< bytes of the file before the first element's values
};

/// Throws Error{malformed_mesh} with the line. Names have printable characters only.
PlyHead read_ply_head(std::string_view file, const std::stop_token& stop);

/// Reads the values of a PLY one after another, in any encoding.
class PlyValues {
 public:
  PlyValues(std::string_view file, const PlyHead& head, const std::stop_token& stop)
      : file_(file),
        encoding_(head.encoding),
        at_(head.size),
        text_(file, at_, stop),
        pace_(stop) {}

  /// Every type's numbers are exact in a double. Throws Error{malformed_mesh} at the file's end and
  /// where a text has no number, and Error{cancelled}.
  double next(PlyType type);

  /// The length of a list, which the rest of the file can hold.
  std::size_t next_count(const PlyProperty& list);

  void skip(const PlyProperty& property);

  /// Throws Error{malformed_mesh} if the rest of the file is too short for the element's values.
  void check_fits(const PlyElement& element) const;

  [[nodiscard]] std::string place() const;  ///< of the latest value
  [[noreturn]] void refuse(const std::string& message) const;

 private:
  [[nodiscard]] std::size_t least_bytes(PlyType type) const;
  [[nodiscard]] std::size_t bytes_left() const;

  std::string_view file_;
  PlyEncoding encoding_;
  std::size_t at_;  ///< the next value's byte, unless the values are text
  TextReader text_;
  Pace pace_;
};

}  // namespace unwrapd::asset::mesh_files
