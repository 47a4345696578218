#include "core/pipeline/note_kept_edges.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/charts/path_edges.hpp"
#include "core/mesh/edges.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd::pipeline {
namespace {

/// The UVs of a face at the ends of one of its edges, that of the lower welded vertex first.
using EndUvs = std::array<Vec2, 2>;

EndUvs uvs_at(const UnwrappedSurface& unwrapped, std::span<const Triangle> welded, Index h) {
  const Vec2& from = unwrapped.uv[static_cast<std::size_t>(start_of(unwrapped.faces, h))];
  const Vec2& to = unwrapped.uv[static_cast<std::size_t>(end_of(unwrapped.faces, h))];
  return start_of(welded, h) < end_of(welded, h) ? EndUvs{from, to} : EndUvs{to, from};
}

/// Whether a face has no area on the page: it lies on one of its edges, and its others are no
/// seams.
bool is_collapsed(const UnwrappedSurface& unwrapped, Index face) {
  const Triangle& corners = unwrapped.faces[static_cast<std::size_t>(face)];
  const auto uv = [&](std::size_t k) -> const Vec2& {
    return unwrapped.uv[static_cast<std::size_t>(corners[k])];
  };
  return uv(0) == uv(1) || uv(1) == uv(2) || uv(2) == uv(0);
}

/// How many edges have faces with different UVs; also edges of three faces or more. edges:
/// ascending.
std::size_t cut_edges_of(const UnwrappedSurface& unwrapped, std::span<const Triangle> welded,
                         std::span<const EdgeEnds> edges) {
  std::vector<std::optional<EndUvs>> first(edges.size());
  std::vector<char> is_cut(edges.size(), 0);
  for (Index h = 0; h < static_cast<Index>(3 * welded.size()); ++h) {
    const Index a = start_of(welded, h), b = end_of(welded, h);
    const EdgeEnds edge{std::min(a, b), std::max(a, b)};
    const auto at = std::ranges::lower_bound(edges, edge);
    if (at == edges.end() || *at != edge || is_collapsed(unwrapped, face_of(h))) continue;
    const auto k = static_cast<std::size_t>(at - edges.begin());
    const EndUvs own = uvs_at(unwrapped, welded, h);
    if (first[k] && *first[k] != own) is_cut[k] = 1;
    first[k] = own;
  }
  return static_cast<std::size_t>(std::ranges::count(is_cut, 1));
}

}  // namespace

std::optional<Note> note_kept_edges(std::span<const Surface> surfaces,
                                    std::span<const UnwrappedSurface> unwrapped,
                                    std::span<const SeamPath> kept, const std::stop_token& stop) {
  if (kept.empty()) return std::nullopt;
  std::size_t count = 0, cut = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const TriMesh& mesh = surfaces[s].mesh;
    const std::vector<Index> first_at = weld(mesh.positions, stop);
    const std::vector<Triangle> welded = renumber(mesh.faces, first_at);
    const std::vector<EdgeEnds> edges =
        charts::kept_edges({.surface = static_cast<Index>(s), .kept = kept}, first_at, welded);
    count += edges.size();
    cut += cut_edges_of(unwrapped[s], welded, edges);
  }
  if (cut == 0) return std::nullopt;
  return Note{NoteCode::kept_edges_cut,
              std::to_string(cut) + " of " + std::to_string(count) +
                  " edges of keep_edges are seams nevertheless: the file, seams or materials cut "
                  "the mesh there, or it has no other way to be opened, or no flat map without "
                  "flips and overlaps. Keep fewer edges, or send seams=none for cuts of the file."};
}

}  // namespace unwrapd::pipeline
