#include <algorithm>
#include <array>
#include <cmath>

#include "core/asset/bytes.hpp"
#include "core/asset/mesh_file.hpp"
#include "core/asset/ply.hpp"

namespace unwrapd::asset {
namespace {

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes.at(static_cast<std::size_t>(type));
}

double number_of(PlyType type, const char* bytes) {
  switch (type) {
    case PlyType::i8:
      return load<std::int8_t>(bytes);
    case PlyType::u8:
      return load<std::uint8_t>(bytes);
    case PlyType::i16:
      return load<std::int16_t>(bytes);
    case PlyType::u16:
      return load<std::uint16_t>(bytes);
    case PlyType::i32:
      return load<std::int32_t>(bytes);
    case PlyType::u32:
      return load<std::uint32_t>(bytes);
    case PlyType::f32:
      return load<float>(bytes);
    case PlyType::f64:
      return load<double>(bytes);
  }
  return 0;
}

}  // namespace

std::size_t PlyValues::least_bytes(PlyType type) const {
  return encoding_ == PlyEncoding::text ? 2 : size_of(type);  // a digit and a space
}

std::size_t PlyValues::bytes_left() const {
  return encoding_ == PlyEncoding::text ? text_.bytes_left() + 1 : file_.size() - at_;
}

std::string PlyValues::place() const {
  return encoding_ == PlyEncoding::text ? text_.place() : "byte " + std::to_string(at_);
}

void PlyValues::refuse(const std::string& message) const { refuse_mesh(message, place()); }

double PlyValues::next(PlyType type) {
  if (encoding_ == PlyEncoding::text) return text_.number();
  const std::size_t size = size_of(type);
  if (size > file_.size() - at_) refuse("the file ends within a value");
  std::array<char, 8> bytes{};
  std::copy_n(&file_[at_], size, bytes.begin());
  if (encoding_ == PlyEncoding::big_endian)
    std::reverse(bytes.begin(), bytes.begin() + std::ptrdiff_t(size));
  at_ += size;
  pace_.add(1);
  return number_of(type, bytes.data());
}

std::size_t PlyValues::next_count(const PlyProperty& list) {
  const double count = next(*list.count_type);
  const auto most = static_cast<double>(bytes_left() / least_bytes(list.type));
  if (!(count >= 0 && count <= most) || std::trunc(count) != count)
    refuse("the length of the list \"" + list.name + "\" is negative, or more than the file holds");
  return static_cast<std::size_t>(count);
}

void PlyValues::skip(const PlyProperty& property) {
  const std::size_t count = property.count_type ? next_count(property) : 1;
  for (std::size_t i = 0; i < count; ++i) next(property.type);
}

void PlyValues::check_fits(const PlyElement& element) const {
  std::size_t row = 0;
  for (const PlyProperty& property : element.properties)
    row += least_bytes(property.count_type.value_or(property.type));
  if (row > 0 && static_cast<std::uint64_t>(element.count) > bytes_left() / row)
    refuse("the file is too short for " + std::to_string(element.count) + " of the element \"" +
           element.name + "\"");
}

}  // namespace unwrapd::asset
