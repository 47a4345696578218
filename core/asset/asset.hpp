#pragma once
// Reads and writes assets. The written document is the one that was read, patched: only texture
// coordinates are added and, if a vertex lies on a seam, its copies.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/base/input.hpp"
#include "core/mesh/placement.hpp"
#include "core/mesh/tri_mesh.hpp"
#include "core/types/asset_options.hpp"
#include "core/types/file_repair.hpp"
#include "core/types/note.hpp"

namespace unwrapd::asset {

struct Document;  // the original JSON and buffers, or the OBJ's text; private to asset

/// An asset: the surfaces to unwrap, and the document that write() patches.
class Asset {
 public:
  explicit Asset(std::unique_ptr<Document> document);
  Asset(Asset&&) noexcept;
  Asset& operator=(Asset&&) noexcept;
  ~Asset();

  [[nodiscard]] Format format() const;  ///< of the input
  [[nodiscard]] std::span<const Surface> surfaces() const;
  /// n of the set TEXCOORD_n that write() writes in a format, or in the usual one; 0 in an OBJ.
  [[nodiscard]] int texcoord(Format output) const;
  [[nodiscard]] int texcoord() const;
  [[nodiscard]] std::span<const FileRepair> repairs() const;  ///< in the order of their kinds
  [[nodiscard]] const Document& document() const { return *document_; }
  [[nodiscard]] Document& document() { return *document_; }

 private:
  std::unique_ptr<Document> document_;
};

/// Recognises the format by content; of a zip archive, that of the one asset in it. Returns the
/// surfaces that the options select; write() then applies the options. Throws Error with a JSON
/// pointer or a file position: unknown_format, malformed_*, missing_buffer, external_uri,
/// unsupported_extension, too_many_vertices, too_many_faces, too_much_memory, no_triangles,
/// non_finite_position; invalid_option if the asset has nothing of a name in the options, or an
/// attribute that they name is no number and no colour;
/// body_too_large if an archive unpacks to more than its limit. Throws
/// Error{cancelled}.
Asset read(const Input& input, const ReadLimits& limits, const AssetOptions& options = {});

/// Fills Surface::corner_uv from the set of texture coordinates that the options name, or else from
/// the first, scaled by their KHR_texture_transform as the textures show them.
void read_uvs(Asset& asset);

/// Fills Surface::materials: a glTF's materials by JSON pointer ("/materials/0"), an OBJ's by name;
/// "" where there is none. Meshes that share geometry have the materials of the first.
void name_materials(Asset& asset);

inline constexpr std::size_t kMostShownFaces = 200'000;

/// Where the scene shows the surfaces, in the order of nodes: each as often as nodes show it while
/// that makes no more than kMostShownFaces or twice the asset's own, else once. A surface that no
/// node shows is left out. Empty if the surfaces lie where their own coordinates put them.
std::vector<ShownSurface> shown_surfaces(const Asset& asset);

/// The asset with its new texture coordinates, as one blob (a .gltf embeds its buffers as data
/// URIs). unwrapped has one entry for each of asset.surfaces(). Tangents of replaced texture
/// coordinates are computed again. Throws Error{cancelled}.
std::string write(const Asset& asset, std::span<const UnwrappedSurface> unwrapped, Format output);

/// The origin of the vertices that write() writes: one entry for each unwrapped primitive, or in an
/// OBJ for each mesh.
std::vector<VertexMap> vertex_maps(const Asset& asset, std::span<const UnwrappedSurface> unwrapped,
                                   Format output);

/// Notes about other changes by write(): tangents computed again, texture transforms reset, sets of
/// texture coordinates filled in, polygons written as triangles.
std::vector<Note> side_effects(const Asset& asset, std::span<const UnwrappedSurface> unwrapped,
                               Format output);

}  // namespace unwrapd::asset
