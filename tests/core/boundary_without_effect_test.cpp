// A boundary shape beside a method that chooses the boundary itself.
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/unwrap.hpp"
#include "tests/core/shapes.hpp"

namespace unwrapd {
namespace {

Unwrapped answer_of(const TriMesh& mesh, const UnwrapOptions& options) {
  SerialExecutor serial;
  return unwrap(std::vector{shapes::surface_of(mesh)}, options, {}, serial);
}

TEST(BoundaryWithoutEffect, ChangesNothing) {
  for (const Method method : {Method::slim, Method::bff}) {
    UnwrapOptions options{.method = method, .max_distortion = 2.02};
    const Unwrapped free = answer_of(shapes::cube(), options);
    options.boundary = BoundaryShape::circle;
    const Unwrapped other = answer_of(shapes::cube(), options);
    EXPECT_EQ(other.report.charts.size(), free.report.charts.size());
    EXPECT_EQ(other.surfaces[0].uv, free.surfaces[0].uv);
  }
  EXPECT_NO_THROW(answer_of(shapes::cube(), {.method = Method::bff,
                                             .boundary = BoundaryShape::circle,
                                             .straighten = Straighten::automatic}));
  EXPECT_THROW(
      answer_of(shapes::cube(), {.max_distortion = 2.02, .boundary = BoundaryShape::circle}),
      Error);
}

}  // namespace
}  // namespace unwrapd
