#pragma once
// Assets in and out. The document that came in is the document that goes out, patched: only
// texture coordinates are added and, where a vertex lies on a seam, its copies.

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/tri_mesh.hpp"
#include "core/types/asset_options.hpp"
#include "core/types/file_repair.hpp"

namespace unwrapd::asset {

enum class Format { glb, gltf, obj };

/// "glb", "gltf" or "obj".
std::string_view format_name(Format format);

/// The bytes of a request. Nothing else is ever opened or fetched.
/// buffers: a .gltf's external buffers by the URI that the document uses for them.
struct Input {
  std::string_view document;
  std::map<std::string, std::string_view> buffers;
  std::stop_token stop = {};  ///< of the job: reading looks at it, and so does writing later
};

inline constexpr std::size_t kNoByteLimit = std::numeric_limits<std::size_t>::max();

/// Checked against counts in the document before anything of their size is allocated.
struct ReadLimits {
  std::int64_t max_vertices = 10'000'000;
  std::int64_t max_faces = 20'000'000;
  std::size_t max_bytes = kNoByteLimit;  ///< of memory, of a job
};

struct Document;  // the original JSON and buffers, or the OBJ's text; private to asset

/// An asset as read: its surfaces to unwrap, and the document that write() patches.
class Asset {
 public:
  explicit Asset(std::unique_ptr<Document> document);
  Asset(Asset&&) noexcept;
  Asset& operator=(Asset&&) noexcept;
  ~Asset();

  [[nodiscard]] Format format() const;  ///< as it came in
  [[nodiscard]] std::span<const Surface> surfaces() const;
  [[nodiscard]] std::span<const FileRepair> repairs() const;  ///< in the order of their kinds
  [[nodiscard]] const Document& document() const { return *document_; }
  [[nodiscard]] Document& document() { return *document_; }

 private:
  std::unique_ptr<Document> document_;
};

/// Recognises the format by content. The surfaces are those that the options select; write() then
/// does what they ask for. Throws Error with a JSON pointer or a file position: unknown_format,
/// malformed_*, missing_buffer, external_uri, unsupported_extension, too_many_vertices,
/// too_many_faces, too_much_memory, no_triangles, non_finite_position; invalid_option where the
/// asset has none of what an option names. Throws Error{cancelled}.
Asset read(const Input& input, const ReadLimits& limits, const AssetOptions& options = {});

/// Fills Surface::corner_uv from the set of texture coordinates that the options name, as the
/// textures show it: scaled by their KHR_texture_transform.
void read_uvs(Asset& asset);

/// The asset with its new texture coordinates, as one blob (a .gltf embeds its buffers as data
/// URIs). unwrapped has one entry for each of asset.surfaces(). Tangents that belonged to replaced
/// texture coordinates are made anew. Throws Error{cancelled}.
std::string write(const Asset& asset, std::span<const UnwrappedSurface> unwrapped, Format output);

/// Where the vertices come from that write() writes: one entry for each primitive that is
/// unwrapped, or in an OBJ for each mesh.
std::vector<VertexMap> vertex_maps(const Asset& asset, std::span<const UnwrappedSurface> unwrapped,
                                   Format output);

/// Sentences about what write() changes besides: tangents made anew, transforms of textures reset,
/// sets of texture coordinates filled in, polygons written as triangles.
std::vector<std::string> side_effects(const Asset& asset,
                                      std::span<const UnwrappedSurface> unwrapped, Format output);

}  // namespace unwrapd::asset
