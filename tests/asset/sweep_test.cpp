// Every real asset of the test data, through the whole of asset and back.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <ranges>
#include <tuple>

#include "tests/asset/support.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::asset::test {
namespace {

/// What is refused, and why.
const std::map<std::string, ErrorCode> kRefused = {
    {"cubeQuantized.glb", ErrorCode::malformed_gltf},       // does not name the extension it needs
    {"cubeSomeBadIndices.glb", ErrorCode::malformed_gltf},  // as its name says
};

bool is_compressed(const std::string& file) {
  return file.find("meshopt_compression") != std::string::npos ||
         file.find("KHR_draco") != std::string::npos;
}

std::vector<std::filesystem::path> assets(const std::filesystem::path& data) {
  return files_below(data / "gltf", {".gltf", ".glb"});
}

using Faces = std::vector<std::array<Vec3, 3>>;

void append_faces(Faces& faces, const Surface& surface, const Placement& placement) {
  for (const auto& [a, b, c] : surface.mesh.faces) {
    const auto at = [&](Index v) {
      return placement(surface.mesh.positions[static_cast<std::size_t>(v)]);
    };
    faces.push_back({at(a), at(b), at(c)});
    if (placement.mirrors()) std::swap(faces.back()[1], faces.back()[2]);
  }
}

/// Faces of all surfaces, as points.
Faces faces_of(const Asset& asset) {
  Faces faces;
  for (const Surface& surface : asset.surfaces()) append_faces(faces, surface, {});
  return faces;
}

/// The same, where the first node puts each.
Faces placed_faces_of(const Asset& asset) {
  std::vector<Placement> placements(asset.surfaces().size());
  for (const ShownSurface& shown : shown_surfaces(asset) | std::views::reverse)
    placements[shown.surface] = shown.placement;
  Faces faces;
  for (std::size_t s = 0; s < placements.size(); ++s)
    append_faces(faces, asset.surfaces()[s], placements[s]);
  return faces;
}

TEST(Sweep, EveryAssetComesBackWithAllAttributesAndTheNewUvs) {
  const auto data = test_data();
  if (!data) GTEST_SKIP() << "no test data";
  int read_count = 0;
  for (const auto& path : assets(*data)) {
    SCOPED_TRACE(path);
    const std::string file = bytes_of(path);
    const auto buffers = buffers_beside(path);
    if (const auto refused = kRefused.find(path.filename()); refused != kRefused.end()) {
      EXPECT_EQ(error_of(file).code(), refused->second);
      continue;
    }
    const Asset asset = read(input_of(file, buffers), {}, kPlain);
    const std::vector<UnwrappedSurface> unwrapped = split_everywhere(asset);
    for (const Format format : {Format::glb, Format::gltf}) {
      const std::string answer = write(asset, unwrapped, format);
      EXPECT_EQ(faces_of(read_file(answer)), faces_of(asset));
      const std::vector<ReadPrimitive> after = read_naively(answer);
      expect_same_but_uv(is_compressed(file) ? after : read_naively(file, buffers), after);
    }
    const Asset obj = read_file(write(asset, unwrapped, Format::obj));
    EXPECT_EQ(faces_of(obj), placed_faces_of(asset));
    ++read_count;
  }
  EXPECT_GT(read_count, 85);
}

/// Each face from its lowest corner: meshopt keeps no more than the order around it.
std::vector<ReadPrimitive> from_lowest_corner(std::vector<ReadPrimitive> primitives) {
  for (ReadPrimitive& primitive : primitives)
    for (Face& face : primitive.faces) {
      const std::array<Vec3, 3> points = points_of(face);
      const auto key = [&](std::size_t k) {  // two corners, for faces with two at one place
        const Vec3 &p = points[k], &next = points[(k + 1) % 3];
        return std::tuple(p.x(), p.y(), p.z(), next.x(), next.y(), next.z());
      };
      std::size_t lowest = 0;
      for (std::size_t k = 1; k < 3; ++k)
        if (key(k) < key(lowest)) lowest = k;
      for (auto& [semantic, values] : face)
        std::rotate(values.begin(), values.begin() + std::ptrdiff_t(lowest), values.end());
    }
  return primitives;
}

TEST(Sweep, CompressedAnswersHoldWhatPlainOnesHold) {
  const auto data = test_data();
  int compressed_count = 0;
  if (!data) GTEST_SKIP() << "no test data";
  for (const auto& path : assets(*data)) {
    SCOPED_TRACE(path);
    const std::string file = bytes_of(path);
    const auto buffers = buffers_beside(path);
    if (kRefused.contains(path.filename()) || file.size() > 1'000'000) continue;
    const auto answer = [&](Compression compression) {
      const Asset asset = read(input_of(file, buffers), {}, {.compression = compression});
      return write(asset, split_everywhere(asset), Format::glb);
    };
    const auto plain = from_lowest_corner(read_naively(answer(Compression::none)));
    for (const Compression compression : {Compression::draco, Compression::meshopt}) {
      const std::string compressed = answer(compression);
      const Asset again = read_file(compressed);
      expect_same_but_uv(
          plain,
          from_lowest_corner(read_naively(write(again, split_everywhere(again), Format::glb))));
      compressed_count += is_compressed(compressed) ? 1 : 0;
    }
  }
  EXPECT_GT(compressed_count, 150);
}

TEST(Sweep, FourteenEncodingsOfOneDiskAreOneDisk) {
  const auto data = test_data();
  if (!data) GTEST_SKIP() << "no test data";
  int seen = 0;
  for (const auto& path : files_below(*data / "gltf/derived", {".gltf", ".glb"})) {
    const std::string file = bytes_of(path);
    const Asset asset = read(input_of(file, buffers_beside(path)), {});
    EXPECT_EQ(asset.surfaces().size(), 1U) << path;
    EXPECT_EQ(asset.surfaces()[0].mesh.face_count(), 16719) << path;
    ++seen;
  }
  EXPECT_EQ(seen, 14);
}

TEST(Sweep, EveryObjComesBackWithTheSameFaces) {
  const auto data = test_data();
  if (!data) GTEST_SKIP() << "no test data";
  for (const char* folder : {"disk", "closed", "paper"})
    for (const auto& path : files_below(*data / folder, {".obj"})) {
      SCOPED_TRACE(path);
      const std::string file = bytes_of(path);
      if (path.filename() == "inf_nan.obj") {
        EXPECT_EQ(error_of(file).code(), ErrorCode::non_finite_position);
        continue;
      }
      const Asset asset = read_file(file);
      const std::vector<UnwrappedSurface> unwrapped = split_everywhere(asset);
      EXPECT_EQ(faces_of(read_file(write(asset, unwrapped, Format::obj))), faces_of(asset));
      const std::vector<ReadPrimitive> read = read_naively(write(asset, unwrapped, Format::glb));
      std::size_t faces = 0;
      for (const ReadPrimitive& primitive : read) faces += primitive.faces.size();
      EXPECT_EQ(faces, faces_of(asset).size());
    }
}

TEST(Sweep, AnswersPassTheKhronosValidator) {
  const auto data = test_data();
  const std::filesystem::path tests = UNWRAPD_TESTS_DIR;
  if (!data) GTEST_SKIP() << "no test data";
  if (!std::filesystem::exists(tests / "node_modules/gltf-validator"))
    GTEST_SKIP() << "no gltf-validator: run npm ci in tests";
  const server::TempDir own;
  const std::filesystem::path& folder = own.path();
  std::ofstream list(folder / "list");
  int number = 0;
  std::vector<std::filesystem::path> files = assets(*data);
  for (const auto& obj : files_below(*data / "closed", {".obj"})) files.push_back(obj);
  for (const auto& path : files) {
    const std::string file = bytes_of(path);
    if (kRefused.contains(path.filename()) || path.filename() == "inf_nan.obj") continue;
    const Asset asset = read(input_of(file, buffers_beside(path)), {}, kPlain);
    for (const auto& unwrapped : {split_everywhere(asset), split_nowhere(asset)})
      for (const Format format : {Format::glb, Format::gltf}) {
        const std::filesystem::path answer = folder / std::to_string(number++);
        std::ofstream(answer, std::ios::binary) << write(asset, unwrapped, format);
        list << path.string() << '\t' << answer.string() << '\n';
      }
  }
  list.close();
  const std::string command =
      "node '" + (tests / "asset/validate.mjs").string() + "' '" + (folder / "list").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace unwrapd::asset::test
