#pragma once

#include <string>

#include "pipeline/label/observe/surface.h"

namespace touchtrace::label {

/// Finds the points of hand and object in a frame. Const methods are thread-safe; they throw
/// std::out_of_range for an object that no clip names.
class Observer {
 public:
  virtual ~Observer() = default;

  /// Points of a frame that may be hand, object or what occludes them, with their classes.
  virtual Surface observe(const RgbdFrame& frame, const std::string& object) const = 0;
  /// Sets the classes of points of a frame.
  virtual void classify(const RgbdFrame& frame, const std::string& object,
                        Surface& points) const = 0;
};

}  // namespace touchtrace::label
