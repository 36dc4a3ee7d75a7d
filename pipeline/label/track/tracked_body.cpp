#include "pipeline/label/track/tracked_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/integer_math.h"
#include "pipeline/label/observe/lift.h"

namespace touchtrace::label {
namespace {

constexpr std::size_t max_surface_cells = 400;
constexpr double size_time_s = 0.5, log_size_sigma = 0.7;  // a factor of two
constexpr double body_sigma_m = 0.01;

double log_size(double fraction) { return std::log(std::max(fraction, min_hand_fraction)); }

}  // namespace

double TrackedBody::reach_m() const { return std::min(filter.gate_m(), arm_reach_m); }

double TrackedBody::distance_m(const Eigen::Vector3f& position_m) const {
  if (surface_m.rows() == 0) return std::numeric_limits<double>::infinity();
  const Eigen::Vector3f unmoved = position_m - shift_m.cast<float>();
  const auto square = [&](Eigen::Index axis) {
    return (surface_m.col(axis) - unmoved[axis]).square();
  };
  return std::sqrt((square(0) + square(1) + square(2)).minCoeff());
}

double TrackedBody::misfit(const Place& place) const {
  const double sigmas = gate_sigmas * (place.centroid_m - expected_m()).norm() / reach_m(),
               size_sigmas =
                   (log_size(place.visible_fraction) - log_size(visible_fraction)) / log_size_sigma;
  return 0.5 * (sigmas * sigmas + size_sigmas * size_sigmas);
}

void TrackedBody::measure(const OwnedCells& owned, const CellIndices& cells,
                          const Eigen::Vector3d& at_m, double seconds) {
  if (is_visible)
    filter.measure(at_m, body_sigma_m);
  else
    filter.start(at_m, body_sigma_m);
  centroid_m = at_m;
  const double weight = seen_s > 0.0 ? std::min(1.0, seconds / size_time_s) : 1.0;
  visible_fraction += weight * (owned.visible_fraction(cells) - visible_fraction);
  seen_s += seconds;
  is_visible = true;
  const std::size_t stride = 1 + cells.size() / max_surface_cells;
  surface_m.resize(static_cast<Eigen::Index>(ceil_div(cells.size(), stride)), Eigen::NoChange);
  for (Eigen::Index row = 0; row < surface_m.rows(); ++row)
    surface_m.row(row) =
        owned.cells[cells[stride * static_cast<std::size_t>(row)]].mean_m.transpose();
}

double log_ratio(const TrackedBody& a, const Place& of_a, const TrackedBody& b, const Place& of_b) {
  return a.misfit(of_b) + b.misfit(of_a) - a.misfit(of_a) - b.misfit(of_b);
}

}  // namespace touchtrace::label
