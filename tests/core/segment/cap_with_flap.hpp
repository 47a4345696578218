#pragma once
// A region whose map stays but near a few faces that are new.

#include <gtest/gtest.h>

#include <vector>

#include "core/segment/base/region_pair.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd::segment {

/// A fine cap of a sphere without ten faces at its rim, mapped; then with them.
struct CapWithFlap {
  SegmentationMesh surface = [] {
    const TriMesh mesh = shapes::sphere_cap(40, 20, 0.8);
    return make_segmentation_mesh(mesh, build_halfedges(mesh.faces, mesh.vertex_count()));
  }();
  Region both;

  CapWithFlap() {
    std::vector<Index> flap;
    for (Index t = 0; t < surface.face_count(); ++t)
      (t < surface.face_count() - 10 ? both.faces : flap).push_back(t);
    both.uv = projected(surface, both.faces);
    EXPECT_EQ(test_parameterization(surface, {}, {.most_excess = 1}, both).verdict, Verdict::sound);
    const Region rest = both, added{flap, projected(surface, flap)};
    const std::vector<char> open(surface.length.size(), 0);
    both = beside(surface, rest, added, RegionPair(surface, rest, added).border(open));
    both.mapped = rest.faces.size();
  }
};

}  // namespace unwrapd::segment
