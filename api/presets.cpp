// Presets: what an unwrapping is for, as options. A request overrides any of them.
#include "api/options.hpp"
#include "core/types/chart_rules.hpp"

namespace unwrapd::api {
namespace {

constexpr double kTextureDistortion = 2.02;  // ADR 0047
constexpr int kDracoBits = 14;               // ADR 0049
constexpr int kLightmapPadding = 4;          // light maps are small and filtered
constexpr int kPaperIterations = 10;         // Sec. 4.4 of the paper

/// Every surface in charts of little distortion, no texel twice, textures keep fitting.
JobOptions texture_options() {
  JobOptions options;
  options.unwrap.max_distortion = kTextureDistortion;
  options.unwrap.guarantee = Guarantee::bijective;
  options.asset.texcoord = TexcoordChoice::automatic;
  return options;
}

JobOptions lightmap_options() {
  JobOptions options = texture_options();
  options.unwrap.padding = kLightmapPadding;
  options.asset.texcoord = TexcoordChoice::free;
  return options;
}

JobOptions chart_options() {
  JobOptions options;
  options.asset.texcoord = TexcoordChoice::automatic;
  return options;
}

JobOptions paper_options() {
  JobOptions options = chart_options();
  options.unwrap.stop.iterations = kPaperIterations;
  options.unwrap.guarantee = Guarantee::none;
  options.unwrap.max_charts = 1;
  return options;
}

}  // namespace

JobOptions preset_options(Preset preset) {
  const auto make = [&] {
    switch (preset) {
      case Preset::texture:
        return texture_options();
      case Preset::lightmap:
        return lightmap_options();
      case Preset::chart:
        return chart_options();
      case Preset::paper:
        return paper_options();
    }
    return texture_options();
  };
  JobOptions options = make();
  options.asset.draco_bits = kDracoBits;
  options.preset = preset;
  return options;
}

void yield_to_request(JobOptions& options, const std::function<bool(std::string_view)>& is_given) {
  UnwrapOptions& unwrap = options.unwrap;
  if (!keeps_whole(unwrap) && !unwrap.keeps_uvs()) return;
  if (!is_given("max_distortion")) unwrap.max_distortion.reset();
  if (!is_given("guarantee") && unwrap.guarantee == Guarantee::bijective)
    unwrap.guarantee = Guarantee::flip_free;
}

}  // namespace unwrapd::api
