#pragma once
// What all components of a job have in common while they are segmented one by one: how far the work
// is, and how much of the page each of them takes.

#include <span>

#include "core/measure/rest_triangle.hpp"
#include "core/segment/segment_charts.hpp"
#include "core/segment/shared_segments.hpp"

namespace unwrapd::segment {

/// Where the segmentation of all components stands: they weigh by their faces.
class Account {
 public:
  Account(std::span<const charts::Charts> surfaces, const SegmentWatch& watch) : watch_(watch) {
    for (const charts::Charts& surface : surfaces)
      for (const charts::Chart& component : surface.charts) {
        total_ += faces_of(component);
        area_ += area_in_scene(component, surface.scale);
      }
  }

  /// scale: of the component's surface.
  [[nodiscard]] SegmentRules rules(double max_distortion, const charts::Chart& component,
                                   double scale) const {
    return {.max_distortion = max_distortion,
            .page_area = area_ / area_in_scene(component, scale),
            .on_progress =
                [this, &component](Stage stage, double share) {
                  if (watch_.on_progress)
                    watch_.on_progress(stage, (done_ + share * faces_of(component)) / total_);
                },
            .stop = watch_.stop};
  }
  [[nodiscard]] const std::stop_token& stop() const { return watch_.stop; }
  void finish(std::size_t faces) { done_ += static_cast<double>(faces); }
  void tell() const {
    if (watch_.on_progress) watch_.on_progress(Stage::merge, done_ / total_);
  }

 private:
  static double faces_of(const charts::Chart& component) {
    return static_cast<double>(component.mesh.faces.size());
  }
  static double area_in_scene(const charts::Chart& component, double scale) {
    return scale * scale * measure::surface_area(component.mesh);
  }

  const SegmentWatch& watch_;
  double total_ = 0, done_ = 0;
  double area_ = 0;  ///< in the scene, of all components
};

}  // namespace unwrapd::segment
