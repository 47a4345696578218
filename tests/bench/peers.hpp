#pragma once
// What others make of well-known meshes, as measured once (CPU seconds of one thread of a busy
// machine, padding 2 at 1024 texels, corners welded by position). They are not run here.
//
// xatlas f700c77, as it comes, D_angle up to 2.04, D_area up to 2.05; of bunny at a hundred times
// its size, which gives 42 charts where its own gives 1053. UVAtlas 1.9.2, of up to three runs that
// differ the one with the fewest charts: as its tool comes (stretch .1667), D_angle 2.06 to 2.36;
// and held to a stretch of .02, D_angle 2.015 to 2.026.

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
  PeerFigures xatlas, uvatlas, uvatlas_held;
};

inline constexpr std::array kPeers = {
    PeerRow{"spot", {39, 12.29, .565, .3}, {11, 7.59, .612, 8.1}, {38, 12.96, .680, 8.5}},
    PeerRow{"cow", {93, 19.39, .603, .4}, {28, 10.38, .644, 9.2}, {153, 27.77, .614, 10.2}},
    PeerRow{"homer", {124, 21.19, .565, .9}, {16, 9.31, .638, 18.2}, {241, 35.48, .575, 19.4}},
    PeerRow{"fandisk", {15, 9.17, .624, .2}, {3, 3.76, .536, 11.8}, {9, 6.78, .686, 13.2}},
    PeerRow{"rocker-arm", {43, 16.79, .532, 4.6}, {7, 5.97, .687, 28.4}, {37, 13.56, .636, 32.6}},
    PeerRow{"suzanne", {70, 14.37, .626, .06}, {13, 6.46, .607, .7}, {52, 14.61, .629, .9}},
    PeerRow{"400-boxes", {2400, 97.56, .478, .2}, {1055, 56.33, .614, 1.1}, {}},
    PeerRow{"torus", {13, 10.85, .429, .2}, {4, 3.50, .525, 2.7}, {10, 6.57, .629, 3.7}},
    PeerRow{"bunny", {42, 16.83, .549, 23}, {12, 7.34, .644, 7.4}, {50, 15.60, .671, 13.3}},
    PeerRow{"nefertiti", {473, 31.84, .559, 25}, {10, 6.67, .639, 18.4}, {}},
    PeerRow{"human_neutral", {215, 22.77, .441, 2.1}, {58, 11.77, .646, 34.3}, {}},
};

}  // namespace unwrapd::bench
