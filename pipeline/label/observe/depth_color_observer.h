#pragma once

#include <map>
#include <memory>
#include <optional>

#include "pipeline/label/observe/color_classes.h"
#include "pipeline/label/observe/observer.h"
#include "pipeline/label/observe/split.h"

namespace touchtrace::label {

/// Classes from colours of points in front of the background. Those of the background are the rest.
class DepthColorObserver : public Observer {
 public:
  explicit DepthColorObserver(std::shared_ptr<const Segmenter> segmenter)
      : segmenter_(std::move(segmenter)) {}

  /// `shared_radius_m`: radius of an object that has colours of the rest; nullopt: it has not.
  void set_colors(const std::string& object, ColorClasses classes,
                  std::optional<double> shared_radius_m) {
    colors_.insert_or_assign(object, Colors{std::move(classes), shared_radius_m});
  }

  Surface observe(const RgbdFrame& frame, const std::string& object) const override {
    const auto& colors = colors_.at(object);
    auto surface = segmenter_->foreground_surface(frame, [&](Surface& points) {
      colors.classes.assign(points);
      std::erase_if(points, [](const SurfacePoint& point) { return point.body == Body::rest; });
    });
    if (colors.shared_radius_m) remove_large_components(surface, *colors.shared_radius_m);
    return surface;
  }
  void classify(const RgbdFrame&, const std::string& object, Surface& points) const override {
    colors_.at(object).classes.assign(points);
    for (auto& point : points)
      if (!point.is_foreground) point.body = Body::rest;
  }

 private:
  struct Colors {
    ColorClasses classes;
    std::optional<double> shared_radius_m;
  };

  std::shared_ptr<const Segmenter> segmenter_;
  std::map<std::string, Colors> colors_;  ///< by object
};

}  // namespace touchtrace::label
