#include "core/pipeline/locked_islands.hpp"

#include <map>
#include <string>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/mesh/repair.hpp"
#include "core/pack/pack_around.hpp"

namespace unwrapd::pipeline {
namespace {

[[noreturn]] void refuse_lock(std::size_t number, const std::string& why) {
  throw Error(ErrorCode::invalid_option, why, "/locked_islands/" + std::to_string(number));
}

/// Which island the faces of each surface lie in; made where it is asked for.
class IslandsOfFaces {
 public:
  explicit IslandsOfFaces(std::span<const charts::UvIslands> all) : all_(all) {}

  /// kNoFace: the face lies in none.
  Index operator()(std::size_t surface, Index face, Index faces) {
    const auto [found, is_new] = of_.try_emplace(surface);
    std::vector<Index>& island = found->second;
    if (is_new) {
      island.assign(static_cast<std::size_t>(faces), kNoFace);
      const std::vector<charts::Chart>& charts = all_[surface].charts.charts;
      for (std::size_t k = 0; k < charts.size(); ++k)
        for (const Index own : charts[k].face_source)
          island[static_cast<std::size_t>(own)] = static_cast<Index>(k);
    }
    return island[static_cast<std::size_t>(face)];
  }

 private:
  const std::span<const charts::UvIslands> all_;
  std::map<std::size_t, std::vector<Index>> of_;
};

/// The island that a face lies in. number: of its entry of locked_islands.
std::size_t island_at(std::span<const Surface> surfaces, IslandsOfFaces& islands,
                      const IslandAtFace& at, std::size_t number) {
  const auto surface = static_cast<std::size_t>(at.surface);
  if (at.surface < 0 || surface >= surfaces.size())
    refuse_lock(number, "there is no mesh " + std::to_string(at.surface) +
                            "; name one of the asset's " + std::to_string(surfaces.size()) +
                            ", counted from 0");
  const Index faces = surfaces[surface].mesh.face_count();
  if (at.face < 0 || at.face >= faces)
    refuse_lock(number, "there is no face " + std::to_string(at.face) +
                            "; name one of the mesh's " + std::to_string(faces) +
                            ", counted from 0");
  const Index island = islands(surface, at.face, faces);
  if (island == kNoFace)
    refuse_lock(number, "face " + std::to_string(at.face) +
                            " has no texture coordinates; name a face of an island");
  return static_cast<std::size_t>(island);
}

[[noreturn]] void refuse_place(std::size_t number, Index face, int pages, bool is_on_one) {
  const std::string advice = is_on_one ? "raise max_pages, or do not lock it, so that it is packed"
                                       : "move it onto one page, or do not lock it";
  refuse_lock(number, "the island of face " + std::to_string(face) +
                          " does not lie on one of the " + std::to_string(pages) + " pages; " +
                          advice);
}

}  // namespace

std::vector<std::vector<char>> locked_islands(std::span<const Surface> surfaces,
                                              const std::vector<charts::UvIslands>& all,
                                              const UnwrapOptions& options,
                                              const std::stop_token& stop) {
  constexpr int kAnyNumber = 1'000'000;
  const double aspect = options.page_size().aspect();
  IslandsOfFaces islands(all);
  std::vector<std::vector<char>> is_locked;
  for (const charts::UvIslands& own : all) is_locked.emplace_back(own.maps.size(), 0);
  for (std::size_t i = 0; i < options.locked_islands.size(); ++i) {
    const IslandAtFace& at = options.locked_islands[i];
    check_cancelled_every(i, stop);
    const std::size_t k = island_at(surfaces, islands, at, i);
    const auto s = static_cast<std::size_t>(at.surface);
    const int pages = options.packing.max_pages;
    const charts::Outline& outline = all[s].outlines[k];
    if (pack::page_holding(outline, aspect, pages) < 0)
      refuse_place(i, at.face, pages, pack::page_holding(outline, aspect, kAnyNumber) >= 0);
    is_locked[s][k] = 1;
  }
  return is_locked;
}

}  // namespace unwrapd::pipeline
