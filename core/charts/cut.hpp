#pragma once
// Any connected surface opened to a disk.

#include "core/mesh/halfedges.hpp"

namespace unwrapd::charts {

/// Removes twins so that the surface becomes a disk; holes that it has already may stay. For a
/// closed surface of genus 0 that is a path of two edges or more between two far vertices; for one
/// with handles, two loops a handle (one cut graph, dangling branches pruned). A disk is left as it
/// is. mesh is connected, its faces index vertices of one fan each (see corner_vertices()).
void cut_to_disk(const TriMesh& mesh, Halfedges& halfedges);

}  // namespace unwrapd::charts
