#pragma once

namespace touchtrace {

/// Position of the vertex of the parabola through (-1, left), (0, middle), (1, right). Infinite or
/// NaN if the three points are collinear.
inline double parabola_vertex(double left, double middle, double right) {
  return 0.5 * (left - right) / (left - 2.0 * middle + right);
}

}  // namespace touchtrace
