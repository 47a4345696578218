#pragma once
// A mesh to try the service with, made from a formula: a ruffled shell, open at its rim and with a
// round hole off its middle.

#include <string>

namespace unwrapd::client {

/// As a GLB with positions and normals, without UVs. Faces: 2 * rings * segments (20,164 as it
/// stands). The same bytes on every call.
std::string sample_glb();

}  // namespace unwrapd::client
