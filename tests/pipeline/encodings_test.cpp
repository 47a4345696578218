// One disk in fourteen encodings: whatever way its bytes are packed, its UVs are the same, up to a
// similarity and what the encoding itself rounded away.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>

#include "core/asset/asset.hpp"
#include "core/unwrap.hpp"
#include "tests/core/obj_reader.hpp"

namespace unwrapd {
namespace {

struct Encoding {
  const char* name;
  double tolerance;  ///< RMS distance of UVs, as a share of the square root of the UV area
};

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Mapped {
  std::vector<Vec3> position;  ///< in the bounding box [0,1]^3 of the mesh: encodings rescale
  UvMap uv;
};

void into_unit_box(std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = points.front();
  for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  for (Vec3& p : points) p = (p - low).cwiseQuotient(high - low);
}

/// Converged maps of nearly equal meshes may lie in different minima, and mending flips adds to
/// that: what is compared is what the readers gave.
const UnwrapOptions kPlain{
    .stop = {.iterations = 10}, .initial = InitialMap::mean_value, .guarantee = Guarantee::none};

Mapped unwrapped(const std::filesystem::path& path) {
  asset::Input input;
  const std::string document = bytes_of(path),
                    buffer = bytes_of(path.parent_path() / "demosthenes16k_ext.bin");
  input.document = document;
  input.buffers["demosthenes16k_ext.bin"] = buffer;
  const asset::Asset asset = asset::read(input, {});
  SerialExecutor serial;
  const Unwrapped u = unwrap(asset.surfaces(), kPlain, {}, serial);
  Mapped mapped;
  const UnwrappedSurface& s = u.surfaces.front();
  for (Index v : s.source)
    mapped.position.push_back(asset.surfaces().front().mesh.positions[std::size_t(v)]);
  mapped.uv = s.uv;
  into_unit_box(mapped.position);
  EXPECT_EQ(u.surfaces.size(), 1U);
  EXPECT_EQ(u.report.charts.size(), 1U);
  return mapped;
}

/// For each point of from, the UV of the nearest point of to.
UvMap carried(const Mapped& from, const Mapped& to) {
  std::vector<std::size_t> order(to.position.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return to.position[a].x() < to.position[b].x(); });
  UvMap uv;
  for (const Vec3& p : from.position) {
    constexpr double kWindow = 0.02;
    const auto first =
        std::lower_bound(order.begin(), order.end(), p.x() - kWindow,
                         [&](std::size_t v, double x) { return to.position[v].x() < x; });
    std::size_t nearest = order.front();
    for (auto it = first; it != order.end() && to.position[*it].x() <= p.x() + kWindow; ++it)
      if ((to.position[*it] - p).squaredNorm() < (to.position[nearest] - p).squaredNorm())
        nearest = *it;
    uv.push_back(to.uv[nearest]);
  }
  return uv;
}

/// RMS distance after the similarity that takes a to b best, in units of b's RMS radius.
double similarity_residual(const UvMap& a, const UvMap& b) {
  const double n = double(a.size());
  const Vec2 mean_a = std::accumulate(a.begin(), a.end(), Vec2(0, 0)) / n;
  const Vec2 mean_b = std::accumulate(b.begin(), b.end(), Vec2(0, 0)) / n;
  double dot = 0, cross = 0, norm_a = 0, norm_b = 0;
  for (std::size_t v = 0; v < a.size(); ++v) {
    const Vec2 p = a[v] - mean_a, q = b[v] - mean_b;
    dot += p.dot(q), cross += p.x() * q.y() - p.y() * q.x();
    norm_a += p.squaredNorm(), norm_b += q.squaredNorm();
  }
  return std::sqrt(std::max(0.0, 1 - (dot * dot + cross * cross) / (norm_a * norm_b)));
}

TEST(Encodings, OfOneDiskGiveTheSameUvs) {
  const std::filesystem::path folder = test_data() / "gltf" / "derived";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no test data (UNWRAPD_TEST_DATA)";
  const Mapped reference = unwrapped(folder / "demosthenes16k_u32.glb");
  for (const Encoding& encoding : std::initializer_list<Encoding>{{"3prims.glb", 1e-6},
                                                                  {"4instances.glb", 1e-6},
                                                                  {"datauri.gltf", 1e-6},
                                                                  {"ext.gltf", 1e-6},
                                                                  {"flatnormals.glb", 1e-6},
                                                                  {"nonindexed.glb", 1e-6},
                                                                  {"u16.glb", 1e-6},
                                                                  {"uvplanar.glb", 1e-6},
                                                                  {"draco_eb_q14.glb", 3e-4},
                                                                  {"draco_seq_q11.glb", 2e-3},
                                                                  {"draco_eb_q8_lossy.glb", 0.015},
                                                                  {"meshopt.glb", 3e-4},
                                                                  {"quant_i16.glb", 1e-4}}) {
    SCOPED_TRACE(encoding.name);
    const Mapped other = unwrapped(folder / (std::string("demosthenes16k_") + encoding.name));
    const double gap = similarity_residual(reference.uv, carried(reference, other));
    std::printf("%-20s %.2e\n", encoding.name, gap);
    EXPECT_LT(gap, encoding.tolerance);
  }
}

}  // namespace
}  // namespace unwrapd
