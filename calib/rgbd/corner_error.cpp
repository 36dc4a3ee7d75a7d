#include "calib/rgbd/corner_error.h"

#include <algorithm>
#include <cmath>

namespace touchtrace {

double num_corner_coordinates(const BoardObservations& observations,
                              const std::vector<bool>& used) {
  std::size_t corners = 0;
  for (std::size_t view = 0; view < used.size(); ++view)
    if (used[view]) corners += observations.views[view].corners_px.size();
  return 2.0 * static_cast<double>(corners);
}

double sum_of_squares(const BoardObservations& observations, const std::vector<bool>& used,
                      const RgbdParameters& parameters) {
  double sum = 0.0;
  for (std::size_t view = 0; view < used.size(); ++view)
    if (used[view])
      for (const auto& residual : corner_residuals(observations, view, parameters))
        sum += residual.squaredNorm();
  return sum;
}

double rms(const std::vector<Eigen::Vector2d>& residuals) {
  double sum = 0.0;
  for (const auto& residual : residuals) sum += residual.squaredNorm();
  return residuals.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(residuals.size()));
}

double rms_of_used_views(const BoardObservations& observations, const std::vector<bool>& used,
                         const RgbdParameters& parameters) {
  const double corners = 0.5 * num_corner_coordinates(observations, used);
  return corners > 0.0 ? std::sqrt(sum_of_squares(observations, used, parameters) / corners) : 0.0;
}

double corner_noise_px(const BoardObservations& observations, const std::vector<bool>& used,
                       std::size_t free_color, const RgbdParameters& parameters) {
  const double unknowns = static_cast<double>(free_color) + 2.0 +
                          6.0 * static_cast<double>(std::ranges::count(used, true));
  const double freedom = std::max(1.0, num_corner_coordinates(observations, used) - unknowns);
  return std::max(std::sqrt(sum_of_squares(observations, used, parameters) / freedom),
                  min_corner_sigma_px);
}

}  // namespace touchtrace
