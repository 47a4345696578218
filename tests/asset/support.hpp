#pragma once
// What the tests of asset share: small documents, made-up UVs, and a second reader of glTF that
// knows nothing of the one under test.

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/asset/asset.hpp"
#include "core/base/error.hpp"

namespace unwrapd::asset::test {

using Json = nlohmann::ordered_json;

/// Bytes and the views and accessors over them, put together into a document.
class Builder {
 public:
  Json json = Json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}], "meshes": [{"primitives": []}], "accessors": [], "bufferViews": [],
    "buffers": [{}]})");
  std::string bin;

  /// Numbers in the component type, tight, in a view of their own. Gives the accessor's number.
  std::size_t add(const std::string& type, int component_type, const std::vector<double>& values);
  std::size_t add_view(const std::string& bytes);

  /// A primitive of mesh 0 with these attributes.
  Json& add_primitive(const std::map<std::string, std::size_t>& attributes,
                      std::optional<std::size_t> indices = std::nullopt);

  [[nodiscard]] std::string glb() const;
  [[nodiscard]] std::string gltf() const;  ///< with a data URI
};

/// A unit square of two triangles, its positions and u16 indices accessors 0 and 1.
Builder square();

/// An n by n grid of quads, bent so that no two vertices are alike.
Builder grid(int n);

std::string glb_of(const std::string& json, const std::string& bin);
Json json_of(const std::string& file);  ///< of a GLB or .gltf

/// Answers of what is read so are plain, whatever came in: the second reader decodes nothing.
inline const AssetOptions kPlain = {.compression = Compression::none};

Asset read_file(const std::string& document, const AssetOptions& options = kPlain);

/// The error that reading ends with; fails the test when there is none.
Error error_of(const std::string& document, const ReadLimits& limits = {});

/// Reads a file and writes it in every format, or gets an Error of the file.
void try_file(const std::string& document);

/// A UV that depends on nothing but where the face and the corner are: whoever reads an answer can
/// tell what its UVs must be.
std::array<double, 2> uv_of(const std::array<Vec3, 3>& face, int corner);

/// Every face gets vertices of its own, with the UVs of uv_of().
std::vector<UnwrappedSurface> split_everywhere(const Asset& asset);

/// No vertex is split; vertex i gets (i % 97 / 97, i % 89 / 89).
std::vector<UnwrappedSurface> split_nowhere(const Asset& asset);

/// A triangle as the second reader sees it: [semantic][corner], raw components; morph targets
/// under "0/POSITION" and so on.
using Face = std::map<std::string, std::array<std::vector<double>, 3>>;

struct ReadPrimitive {
  std::vector<Face> faces;
  Json json;
};

/// The triangles of all primitives of a plain document, read naively from its bytes.
std::vector<ReadPrimitive> read_naively(const std::string& file,
                                        const std::map<std::string, std::string>& buffers = {});

/// The three points of a face, POSITION normalised as its accessor says.
std::array<Vec3, 3> points_of(const Face& face);

/// Answers carry over every attribute of every face, and their UVs are those of uv_of().
void expect_same_but_uv(const std::vector<ReadPrimitive>& input,
                        const std::vector<ReadPrimitive>& answer);

/// Empty when there is no test data: skip the test then.
std::optional<std::filesystem::path> test_data();
std::string bytes_of(const std::filesystem::path& file);

/// All files below a folder whose names end so, sorted.
std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder,
                                               const std::vector<std::string>& endings);

/// The buffers beside a .gltf, by the URIs it uses.
std::map<std::string, std::string> buffers_beside(const std::filesystem::path& file);
Input input_of(const std::string& document, const std::map<std::string, std::string>& buffers);

}  // namespace unwrapd::asset::test
