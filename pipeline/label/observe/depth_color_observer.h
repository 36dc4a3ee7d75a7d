#pragma once

#include <map>
#include <memory>

#include "pipeline/label/observe/color_classes.h"
#include "pipeline/label/observe/observer.h"

namespace touchtrace::label {

/// Classes from colours of points in front of the background. Those of the background are the rest.
class DepthColorObserver : public Observer {
 public:
  explicit DepthColorObserver(std::shared_ptr<const Segmenter> segmenter)
      : segmenter_(std::move(segmenter)) {}

  void set_colors(const std::string& object, ColorClasses classes) {
    colors_.insert_or_assign(object, std::move(classes));
  }

  Surface observe(const RgbdFrame& frame, const std::string& object) const override {
    const auto& classes = colors_.at(object);
    return segmenter_->foreground_surface(frame, [&](Surface& points) { classes.assign(points); });
  }
  void classify(const RgbdFrame&, const std::string& object, Surface& points) const override {
    colors_.at(object).assign(points);
    for (auto& point : points)
      if (!point.is_foreground) point.body = Body::rest;
  }

 private:
  std::shared_ptr<const Segmenter> segmenter_;
  std::map<std::string, ColorClasses> colors_;  ///< by object
};

}  // namespace touchtrace::label
