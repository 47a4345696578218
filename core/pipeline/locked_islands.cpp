#include "core/pipeline/locked_islands.hpp"

#include <Eigen/Geometry>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/cancel.hpp"
#include "core/base/error.hpp"
#include "core/guarantee/quantize_uvs.hpp"
#include "core/mesh/repair.hpp"
#include "core/pack/pack_around.hpp"
#include "core/pipeline/place_islands.hpp"

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
                      const LockedIsland& at, std::size_t number) {
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

/// "the island of face 7", and of which mesh where there are several.
std::string named(const LockedIsland& wanted, std::size_t meshes) {
  const std::string mesh = meshes > 1 ? " of mesh " + std::to_string(wanted.surface) : "";
  return "the island of face " + std::to_string(wanted.face) + mesh;
}

[[noreturn]] void refuse_place(std::size_t number, const std::string& island, int pages,
                               bool is_on_one) {
  const std::string advice = is_on_one ? "raise max_pages, or do not lock it, so that it is packed"
                                       : "move it onto one page, or do not lock it";
  const std::string where =
      pages == 1 ? "the page" : "one of the " + std::to_string(pages) + " pages";
  refuse_lock(number, island + " does not lie on " + where + "; " + advice);
}

[[noreturn]] void refuse_two_places(std::size_t number, const std::string& island,
                                    std::size_t earlier) {
  refuse_lock(number, island + " has another turn or move in entry " + std::to_string(earlier) +
                          "; name each island once");
}

/// Turned about the middle of its box, then moved; on a page that is not square turning keeps
/// lengths in texels.
class Motion {
 public:
  Motion(const LockedIsland& wanted, const charts::Outline& outline, const PageSize& page)
      : turn_(wanted.turn / 180 * std::numbers::pi),
        move_(wanted.move.x(), wanted.move.y() * page.aspect()) {
    const auto [low, high] = charts::bounds_of(outline);
    middle_ = (low + high) / 2;
  }

  Vec2 operator()(const Vec2& point) const { return turn_ * (point - middle_) + middle_ + move_; }

 private:
  Eigen::Rotation2Dd turn_;
  Vec2 move_, middle_;
};

void lay(const LockedIsland& wanted, const PageSize& page, charts::Outline& outline, UvMap& map) {
  const Motion motion(wanted, outline, page);
  for (auto& side : outline)
    for (Vec2& end : side) end = motion(end);
  to_page_widths(map, page);
  for (Vec2& point : map) point = motion(point);
  to_uvs(map, page);
  guarantee::round_to_step(map);
}

}  // namespace

std::vector<std::vector<char>> lay_locked_islands(std::span<const Surface> surfaces,
                                                  const UnwrapOptions& options,
                                                  const std::stop_token& stop,
                                                  std::vector<charts::UvIslands>& all) {
  constexpr int kAnyNumber = 1'000'000;
  const PageSize page = options.page_size();
  const int pages = options.packing.max_pages;
  IslandsOfFaces islands(all);
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> entries;  // by surface and island
  std::vector<std::vector<char>> is_locked;
  for (const charts::UvIslands& own : all) is_locked.emplace_back(own.maps.size(), 0);
  for (std::size_t i = 0; i < options.locked_islands.size(); ++i) {
    const LockedIsland& wanted = options.locked_islands[i];
    check_cancelled_every(i, stop);
    const std::size_t k = island_at(surfaces, islands, wanted, i);
    const auto s = static_cast<std::size_t>(wanted.surface);
    const auto [earlier, is_first] = entries.try_emplace({s, k}, i);
    if (!is_first) {
      if (!options.locked_islands[earlier->second].has_place_of(wanted))
        refuse_two_places(i, named(wanted, surfaces.size()), earlier->second);
      continue;
    }
    charts::Outline& outline = all[s].outlines[k];
    if (!wanted.stays()) lay(wanted, page, outline, all[s].maps[k]);
    if (pack::page_holding(outline, page.aspect(), pages) < 0)
      refuse_place(i, named(wanted, surfaces.size()), pages,
                   pack::page_holding(outline, page.aspect(), kAnyNumber) >= 0);
    is_locked[s][k] = 1;
  }
  return is_locked;
}

}  // namespace unwrapd::pipeline
