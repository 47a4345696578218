#pragma once
// Decodes one Draco bitstream.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/base/input.hpp"
#include "core/asset/gltf/gltf.hpp"

namespace draco {
class Mesh;
}

namespace unwrapd::asset::codec {

class DracoMesh {
 public:
  /// Throws Error{malformed_draco} with the place if the bitstream is damaged, is not a mesh, or
  /// claims more than its bytes or the limits allow.
  DracoMesh(std::string_view bytes, const ReadLimits& limits, const Place& place);
  ~DracoMesh();
  DracoMesh(const DracoMesh&) = delete;
  DracoMesh& operator=(const DracoMesh&) = delete;

  [[nodiscard]] std::size_t point_count() const;
  [[nodiscard]] std::vector<Index> corners() const;  ///< three to a face, in range

  /// The attribute as elements of the accessor's type, each padded to 4 bytes. Throws
  /// Error{malformed_draco} if there is no such attribute.
  [[nodiscard]] std::string elements(std::size_t id, const Accessor& accessor) const;

 private:
  std::unique_ptr<draco::Mesh> mesh_;
  Place place_;
};

}  // namespace unwrapd::asset::codec
