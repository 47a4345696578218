#pragma once
// What others make of well-known meshes, as measured once (CPU seconds of one thread, padding 2 at
// 1024 texels). They are not run here.

#include <array>
#include <string_view>

namespace unwrapd::bench {

/// charts 0: it fails, or was not measured.
struct PeerFigures {
  int charts = 0;
  double seam = 0, fill = 0, seconds = 0;
};

struct PeerRow {
  std::string_view mesh;  ///< a file's name without its ending
  PeerFigures xatlas, uvatlas;
};

inline constexpr std::array kPeers = {
    PeerRow{"spot", {39, 12.3, .565, .58}, {10, 7.31, .646, 12.9}},
    PeerRow{"cow", {93, 19.4, .603, .59}, {29, 10.7, .595, 13.5}},
    PeerRow{"homer", {124, 21.2, .565, 1.5}, {16, 9.31, .633, 26.7}},
    PeerRow{"fandisk", {15, 9.17, .623, .36}, {3, 3.76, .536, 14.3}},
    PeerRow{"rocker-arm", {43, 16.8, .532, 8.4}, {}},
    PeerRow{"suzanne", {70, 14.4, .626, .09}, {}},
    PeerRow{"400-boxes", {2400, 97.7, .495, .22}, {1019, 56.4, .602, 1.6}},
    PeerRow{"torus", {11, 9.67, .520, .75}, {4, 3.47, .521, 10.8}},
    PeerRow{"nefertiti", {473, 31.8, .559, 44}, {}},
};

}  // namespace unwrapd::bench
