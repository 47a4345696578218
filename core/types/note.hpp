#pragma once
// What a user should know of a result: a code for programs and a sentence for people.

#include <string>

namespace unwrapd {

/// Why there is a note. The names on the wire are in api/report.cpp, in this order.
enum class NoteCode {
  option_unused,         ///< an option has no effect here
  overlaps,              ///< triangles of a chart share texels
  distorted,             ///< a chart is distorted beyond what textures bear
  set_chosen,            ///< another set of texture coordinates than the first was written
  textures_lost,         ///< images of the asset do not fit the new texture coordinates
  textures_transferred,  ///< images are painted anew for the new texture coordinates
  charts_exceeded,       ///< more charts than max_charts
  surface_noisy,         ///< noise leaves no room for max_distortion
  chart_remapped,        ///< a chart overlapped itself and got a new map, or was cut
  outside_page,          ///< constraints put charts outside the page
  padding_reduced,       ///< there are too many islands for the padding
  islands_stacked,       ///< islands of the same shape lie on each other
  faces_without_uvs,     ///< faces have no texture coordinates to pack
  tangents_changed,      ///< tangents are computed again, or left out
  transform_reset,       ///< a KHR_texture_transform is removed
  materials_copied,      ///< materials have copies for the unwrapped primitives
  morph_targets_lost,    ///< morph targets no longer move texture coordinates
  sets_filled,           ///< lower sets of texture coordinates were missing
  images_separate,       ///< images remain in files beside the result
  polygons_split,        ///< polygons are written as triangles
  format_changed,        ///< the format of the input is not written
  data_dropped,          ///< materials or properties of the input are not in the result
  positions_rounded,     ///< positions are rounded: by Draco, or to floats that cannot hold a face
  origin_moved,          ///< positions are relative to the translation of the node
  lambda_repeated,       ///< charts have maps that come from those of another lambda of the list
  kept_edges_cut,        ///< seams run along edges of keep_edges nevertheless
  islands_tiny,          ///< islands have less area than one texel
  nodes_stretch,         ///< nodes show meshes longer in one direction than in another
};

struct Note {
  NoteCode code = NoteCode::option_unused;
  std::string text;  ///< a sentence or two: what happened, and what to do about it
};

}  // namespace unwrapd
