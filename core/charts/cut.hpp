#pragma once
// Cuts any connected surface open to a disk.

#include <span>

#include "core/mesh/halfedges.hpp"

namespace unwrapd::charts {

/// Removes twins so that the surface becomes a disk. Holes that it has may stay. A closed surface
/// of genus 0 is cut along a path of two edges or more between two distant vertices; one with
/// handles along two loops a handle (one cut graph without dangling branches). A disk is left as it
/// is. mesh is connected; its faces index vertices of one fan each (see corner_vertices()). avoid:
/// see Chart; the cut goes around what is painted.
void cut_to_disk(const TriMesh& mesh, Halfedges& halfedges, std::span<const double> avoid = {});

}  // namespace unwrapd::charts
