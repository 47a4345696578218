#include "core/pipeline/note_kept_edges.hpp"

#include <string>
#include <vector>

#include "core/charts/path_edges.hpp"
#include "core/measure/seam_length.hpp"
#include "core/mesh/weld.hpp"

namespace unwrapd::pipeline {

std::optional<Note> note_kept_edges(std::span<const Surface> surfaces, const Prepared& all,
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
    const std::vector<Index>& twin = all.surfaces[s].by_position->twin;
    for (Index h = 0; h < static_cast<Index>(twin.size()); ++h)
      if (h < twin[h] && charts::contains_edge(edges, welded, h) &&
          measure::is_seam(unwrapped[s], h, twin[h]))
        ++cut;
  }
  if (cut == 0) return std::nullopt;
  return Note{NoteCode::kept_edges_cut,
              std::to_string(cut) + " of " + std::to_string(count) +
                  " edges of keep_edges are seams nevertheless: the file, seams or materials cut "
                  "the mesh there, or it has no other way to be opened, or no flat map without "
                  "flips and overlaps. Keep fewer edges, or send seams=none for cuts of the file."};
}

}  // namespace unwrapd::pipeline
