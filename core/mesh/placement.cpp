#include "core/mesh/placement.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace unwrapd {

Eigen::Matrix3d Placement::cofactors() const {
  Eigen::Matrix3d cofactor;
  for (int k = 0; k < 3; ++k)
    cofactor.row(k) = linear.row((k + 1) % 3).cross(linear.row((k + 2) % 3));
  return cofactor;
}

bool Placement::mirrors() const { return linear.determinant() < 0; }

}  // namespace unwrapd
