#include <algorithm>
#include <array>
#include <cmath>

#include "core/asset/base/bytes.hpp"
#include "core/asset/mesh_files/mesh_file.hpp"
#include "core/asset/mesh_files/ply.hpp"

namespace unwrapd::asset::mesh_files {
namespace {

struct NumberType {
  std::size_t size;  ///< bytes
  double (*read)(const char*);
};

template <class T>
constexpr NumberType number_type() {
  return {sizeof(T), [](const char* bytes) { return static_cast<double>(load<T>(bytes)); }};
}

/// In the order of PlyType.
constexpr std::array kNumberTypes = {number_type<std::int8_t>(),  number_type<std::uint8_t>(),
                                     number_type<std::int16_t>(), number_type<std::uint16_t>(),
                                     number_type<std::int32_t>(), number_type<std::uint32_t>(),
                                     number_type<float>(),        number_type<double>()};
static_assert(kNumberTypes.size() == static_cast<std::size_t>(PlyType::f64) + 1);

const NumberType& type_of(PlyType type) { return kNumberTypes[static_cast<std::size_t>(type)]; }

}  // namespace

std::size_t PlyValues::least_bytes(PlyType type) const {
  return encoding_ == PlyEncoding::text ? 2 : type_of(type).size;  // a digit and a space
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
  const std::size_t size = type_of(type).size;
  if (size > file_.size() - at_) refuse("the file ends within a value");
  std::array<char, 8> bytes{};
  std::copy_n(&file_[at_], size, bytes.begin());
  if (encoding_ == PlyEncoding::big_endian)
    std::reverse(bytes.begin(), bytes.begin() + std::ptrdiff_t(size));
  at_ += size;
  pace_.add(1);
  return type_of(type).read(bytes.data());
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

}  // namespace unwrapd::asset::mesh_files
