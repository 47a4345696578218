#include "core/asset/gltf_steps.hpp"
namespace unwrapd::asset {
void decode_meshopt(Gltf&) {}
void decode_draco(Gltf&, const std::vector<DracoSource>&, const ReadLimits&) {}
}  // namespace unwrapd::asset
