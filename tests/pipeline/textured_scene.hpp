#pragma once
// A second renderer of textured assets: slow and plain, it knows nothing of core/texture but how
// files are decoded. Used to compare an asset before and after its textures were transferred.

#include <string>
#include <vector>

#include "core/texture/image.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::test {

using Vec4 = Eigen::Vector4d;

struct SceneCorner {
  Vec3 position, normal;
  Vec2 uv;
  Vec4 tangent = Vec4::Zero();
};

struct SceneFace {
  std::array<SceneCorner, 3> corner;
  int material = -1;
};

/// What a point of a face looks like.
enum class Look { base_colour, normals };

class TexturedScene {
 public:
  /// glb: uncompressed, textures in buffer views. set: whose coordinates are chart borders.
  explicit TexturedScene(const std::string& glb);

  [[nodiscard]] const std::vector<SceneFace>& faces() const { return faces_; }

  /// In linear light, or a unit vector of space; weights are barycentric.
  [[nodiscard]] Vec3 look(std::size_t face, const Vec3& weights, Look look) const;

  /// A number for each face, equal where faces are connected by edges without a seam.
  [[nodiscard]] std::vector<int> charts() const;

 private:
  struct Slot {
    int image = -1;
    std::array<int, 2> wrap = {10497, 10497};
    Vec2 offset = Vec2::Zero(), scale = Vec2::Ones();
    double rotation = 0;
  };
  struct Material {
    Slot base, normal;
  };

  [[nodiscard]] Slot slot_of(const asset::test::Json& info) const;
  [[nodiscard]] Vec3 sample(const Slot& slot, const Vec2& uv, bool is_srgb) const;

  asset::test::Json json_;
  std::vector<SceneFace> faces_;
  std::vector<texture::Image> images_;
  std::vector<Material> materials_;
};

/// Two scenes of the same faces side by side.
struct Compared {
  double mean_difference = 0;  ///< of a channel in 1/255, over pixels away from seams
  double near_seams = 0;       ///< the same near seams and silhouettes
  double share_compared = 0;   ///< of the pixels that show a face
  texture::Image before, after;
};

/// direction: from where the scenes are looked at.
Compared compare(const TexturedScene& before, const TexturedScene& after, const Vec3& direction,
                 Look look, int size);

/// The corners of a cube around the scene.
std::vector<Vec3> eight_sides();

}  // namespace unwrapd::test
