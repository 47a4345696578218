// The second reader of glTF: as short and as slow as can be, straight from the specification, and
// without tinygltf, which the reader under test uses.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

int digit_of(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : 63;
}

std::string from_base64(const std::string& text) {
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(digit_of(c));
    if ((count += 6) < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xff);
  }
  return bytes;
}

class NaiveReader {
 public:
  NaiveReader(const std::string& file, const std::map<std::string, std::string>& buffers)
      : document_(json_of(file)) {
    for (const Json& buffer : document_["buffers"]) {
      if (!buffer.contains("uri")) {
        std::uint32_t json_length = 0;
        std::memcpy(&json_length, file.data() + 12, 4);
        buffers_.push_back(file.substr(28 + json_length));
      } else if (const std::string uri = buffer["uri"]; uri.starts_with("data:")) {
        buffers_.push_back(from_base64(uri.substr(uri.find(',') + 1)));
      } else {
        buffers_.push_back(buffers.at(uri));
      }
    }
  }

  std::vector<ReadPrimitive> read() {
    std::vector<ReadPrimitive> primitives;
    for (const Json& mesh : document_["meshes"])
      for (const Json& primitive : mesh["primitives"])
        primitives.push_back({faces_of(primitive), primitive});
    return primitives;
  }

 private:
  using Element = std::vector<double>;

  static std::size_t size_of(int type) { return type < 5122 ? 1 : type < 5124 ? 2 : 4; }

  /// The bytes of a view from an offset on.
  const char* bytes_at(std::size_t view, std::size_t offset) {
    const Json& json = document_["bufferViews"].at(view);
    return buffers_.at(json["buffer"]).data() + json.value("byteOffset", std::size_t{0}) + offset;
  }

  static double number(const char* bytes, int type) {
    std::int8_t i8 = 0;
    std::int16_t i16 = 0;
    std::uint32_t bits = 0;
    float f = 0;
    std::memcpy(&bits, bytes, size_of(type));
    std::memcpy(&i8, &bits, 1);
    std::memcpy(&i16, &bits, 2);
    std::memcpy(&f, &bits, 4);
    return type == 5120 ? i8 : type == 5122 ? i16 : type == 5126 ? static_cast<double>(f) : bits;
  }

  static Element element(const char* bytes, int type, std::size_t components) {
    Element result;
    for (std::size_t k = 0; k < components; ++k)
      result.push_back(number(bytes + k * size_of(type), type));
    return result;
  }

  std::vector<Element> elements(const Json& accessor) {
    const std::map<std::string, std::size_t> sizes = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    const std::size_t components = sizes.at(accessor["type"]);
    const int type = accessor["componentType"];
    const std::size_t tight = components * size_of(type);
    std::vector<Element> result(accessor["count"], Element(components, 0.0));
    if (accessor.contains("bufferView")) {
      const std::size_t view = accessor["bufferView"];
      const std::size_t stride = document_["bufferViews"].at(view).value("byteStride", tight);
      const char* bytes = bytes_at(view, accessor.value("byteOffset", std::size_t{0}));
      for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = element(bytes + i * stride, type, components);
    }
    if (accessor.contains("sparse")) replace(accessor["sparse"], type, components, result);
    if (accessor.value("normalized", false))
      for (Element& e : result)
        for (double& value : e) value = normalized(value, type);
    return result;
  }

  static double normalized(double value, int type) {
    const double largest = type == 5120 ? 127 : type == 5121 ? 255 : type == 5122 ? 32767 : 65535;
    return std::max(value / largest, -1.0);
  }

  void replace(const Json& sparse, int type, std::size_t components, std::vector<Element>& result) {
    const Json& indices = sparse["indices"];
    const Json& values = sparse["values"];
    const int index_type = indices["componentType"];
    const char* index =
        bytes_at(indices["bufferView"], indices.value("byteOffset", std::size_t{0}));
    const char* value = bytes_at(values["bufferView"], values.value("byteOffset", std::size_t{0}));
    for (std::size_t k = 0; k < sparse["count"]; ++k) {
      const double at = number(index + k * size_of(index_type), index_type);
      result.at(static_cast<std::size_t>(at)) =
          element(value + k * components * size_of(type), type, components);
    }
  }

  std::vector<std::array<std::size_t, 3>> triangles(const Json& primitive, std::size_t vertices) {
    std::vector<std::size_t> corners;
    if (primitive.contains("indices"))
      for (const Element& e :
           elements(document_["accessors"].at(primitive["indices"].get<std::size_t>())))
        corners.push_back(static_cast<std::size_t>(e[0]));
    else
      for (std::size_t i = 0; i < vertices; ++i) corners.push_back(i);
    const int mode = primitive.value("mode", 4);
    std::vector<std::array<std::size_t, 3>> result;
    for (std::size_t i = 0; i + 2 < corners.size(); i += mode == 4 ? 3 : 1) {
      std::array<std::size_t, 3> face = {corners[i], corners[i + 1], corners[i + 2]};
      if (mode == 5 && i % 2 == 1) std::swap(face[1], face[2]);
      if (mode == 6) face = {corners[i + 1], corners[i + 2], corners[0]};
      const bool repeats = face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
      if (mode == 4 || !repeats) result.push_back(face);
    }
    return result;
  }

  std::vector<Face> faces_of(const Json& primitive) {
    if (primitive.value("mode", 4) < 4 || !primitive["attributes"].contains("POSITION")) return {};
    std::map<std::string, std::vector<Element>> values;
    for (const auto& [semantic, accessor] : primitive["attributes"].items())
      values[semantic] = elements(document_["accessors"].at(accessor.get<std::size_t>()));
    std::size_t number = 0;
    for (const Json& target : primitive.value("targets", Json::array())) {
      for (const auto& [semantic, accessor] : target.items())
        values[std::to_string(number) + '/' + semantic] =
            elements(document_["accessors"].at(accessor.get<std::size_t>()));
      ++number;
    }
    std::vector<Face> faces;
    for (const auto& corners : triangles(primitive, values["POSITION"].size())) {
      Face& face = faces.emplace_back();
      for (const auto& [semantic, all] : values)
        for (std::size_t k = 0; k < 3; ++k) face[semantic][k] = all.at(corners[k]);
    }
    return faces;
  }

  Json document_;
  std::vector<std::string> buffers_;
};

}  // namespace

std::vector<ReadPrimitive> read_naively(const std::string& file,
                                        const std::map<std::string, std::string>& buffers) {
  return NaiveReader(file, buffers).read();
}

std::array<Vec3, 3> points_of(const Face& face) {
  std::array<Vec3, 3> points;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double>& p = face.at("POSITION")[k];
    points[k] = {p[0], p[1], p[2]};
  }
  return points;
}

namespace {

bool is_tangent(const std::string& semantic) { return semantic.ends_with("TANGENT"); }

/// "0/TANGENT": of a morph target.
bool is_morph_tangent(const std::string& semantic) { return semantic.ends_with("/TANGENT"); }

/// Of unit length, and a sign.
void expect_tangent(const std::vector<double>& tangent) {
  ASSERT_EQ(tangent.size(), 4U);
  EXPECT_NEAR(std::hypot(tangent[0], tangent[1], tangent[2]), 1, 1e-5);
  EXPECT_EQ(std::abs(tangent[3]), 1);
}

}  // namespace

void expect_same_but_uv(const std::vector<ReadPrimitive>& input,
                        const std::vector<ReadPrimitive>& answer) {
  ASSERT_EQ(input.size(), answer.size());
  for (std::size_t i = 0; i < input.size(); ++i) {
    ASSERT_EQ(input[i].faces.size(), answer[i].faces.size()) << "primitive " << i;
    for (std::size_t t = 0; t < input[i].faces.size(); ++t) {
      const Face& before = input[i].faces[t];
      const Face& after = answer[i].faces[t];
      const std::array<Vec3, 3> points = points_of(before);
      ASSERT_TRUE(after.contains("TEXCOORD_0")) << "primitive " << i;
      const auto tangents = std::count_if(before.begin(), before.end(), [](const auto& item) {
        return is_morph_tangent(item.first);
      });
      ASSERT_EQ(after.size() + static_cast<std::size_t>(tangents),
                before.size() + (before.contains("TEXCOORD_0") ? 0 : 1))
          << "morphed tangents of replaced UVs are left out, and nothing else";
      for (int k = 0; k < 3; ++k) {
        const std::vector<double>& uv = after.at("TEXCOORD_0")[static_cast<std::size_t>(k)];
        ASSERT_NEAR(uv[0], uv_of(points, k)[0], 1e-6) << "primitive " << i << ", face " << t;
        ASSERT_NEAR(1 - uv[1], uv_of(points, k)[1], 1e-6) << "primitive " << i << ", face " << t;
      }
      for (const auto& [semantic, values] : before) {
        if (semantic == "TEXCOORD_0" || is_morph_tangent(semantic)) continue;
        ASSERT_TRUE(after.contains(semantic)) << semantic;
        if (is_tangent(semantic)) {
          for (const std::vector<double>& tangent : after.at(semantic)) expect_tangent(tangent);
          continue;
        }
        ASSERT_EQ(after.at(semantic), values)
            << semantic << " of primitive " << i << ", face " << t;
      }
    }
  }
}

}  // namespace unwrapd::asset::test
