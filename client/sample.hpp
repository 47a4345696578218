#pragma once
// A sample mesh, made from a formula: a ruffled shell, open at its rim and with a round hole off
// its middle.

#include <string>

namespace unwrapd::client {

/// A GLB with positions and normals, without UVs. It has 2 * rings * segments faces (20,164 at
/// present). The same bytes on every call.
std::string sample_glb();

}  // namespace unwrapd::client
