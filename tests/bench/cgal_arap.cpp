#include "tests/bench/cgal_arap.hpp"

#ifndef UNWRAPD_HAS_CGAL
std::optional<double> unwrapd::bench::cgal_arap_seconds(const TriMesh&, UvMap&) { return {}; }
#else

#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

#include <ctime>

namespace unwrapd::bench {
namespace {

namespace smp = CGAL::Surface_mesh_parameterization;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Halfedge = boost::graph_traits<Mesh>::halfedge_descriptor;

}  // namespace

std::optional<double> cgal_arap_seconds(const TriMesh& mesh, UvMap& uv) {
  Mesh cgal;
  std::vector<Mesh::Vertex_index> vertex;
  for (const Vec3& p : mesh.positions) vertex.push_back(cgal.add_vertex({p.x(), p.y(), p.z()}));
  for (const auto& [a, b, c] : mesh.faces)
    cgal.add_face(vertex[std::size_t(a)], vertex[std::size_t(b)], vertex[std::size_t(c)]);
  auto uv_map = cgal.add_property_map<Mesh::Vertex_index, Kernel::Point_2>("v:uv").first;
  const Halfedge border = CGAL::Polygon_mesh_processing::longest_border(cgal).first;

  const std::clock_t start = std::clock();
  using Parameterizer = smp::ARAP_parameterizer_3<Mesh>;
  constexpr double kLambda = 1000, kNoTolerance = 0;  // its default lambda; all ten iterations
  Parameterizer parameterizer({}, {}, kLambda, 10, kNoTolerance);
  const smp::Error_code error = smp::parameterize(cgal, parameterizer, border, uv_map);
  const double took = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;

  uv.clear();
  for (auto v : vertex) uv.emplace_back(uv_map[v].x(), uv_map[v].y());
  if (error != smp::OK) return std::nullopt;
  return took;
}

}  // namespace unwrapd::bench

#endif
