#include "calib/board/corner_lattice.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/board/saddle.h"

namespace touchtrace {
namespace {

constexpr double sampled_place = 0.25;  ///< in a square, as a fraction of its side from the corner
constexpr double max_prediction_error = 0.25;  ///< fraction of a square's side
constexpr int min_radius_px = 2, max_radius_px = 10;

/// Mean of 3x3 pixels, which averages noise; nullopt outside the image.
std::optional<double> mean_grey(const GreyImage& image, const Eigen::Vector2d& at) {
  if (!(at.minCoeff() >= 1.0 && at.x() <= image.width - 2.0 && at.y() <= image.height - 2.0))
    return {};
  const auto column = std::lround(at.x()), row = std::lround(at.y());
  double sum = 0.0;
  for (auto v = row - 1; v <= row + 1; ++v)
    for (auto u = column - 1; u <= column + 1; ++u)
      sum += image.pixels[static_cast<std::size_t>(v * image.width + u)];
  return sum / 9.0;
}

/// Side of a square [px] from a known corner in the direction of a positive step.
std::optional<Eigen::Vector2d> side_px(const CornerLattice& lattice, const LatticeCell& cell,
                                       const LatticeCell& step) {
  const auto here = lattice.find(cell), next = lattice.find(cell + step),
             before = lattice.find(cell - step);
  if (here == lattice.end()) return {};
  if (next != lattice.end()) return next->second - here->second;
  if (before != lattice.end()) return here->second - before->second;
  return {};
}

/// Image of the unit square with these corners, as a homography of steps along `step` and `across`.
std::optional<cv::Matx33d> square_homography(const CornerLattice& lattice, const LatticeCell& cell,
                                             const LatticeCell& step, const LatticeCell& across) {
  const std::array cells{cell, cell - step, cell + across, cell - step + across};
  const cv::Point2f on_square[] = {{0, 0}, {-1, 0}, {0, 1}, {-1, 1}};
  cv::Point2f in_image[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = lattice.find(cells[i]);
    if (corner == lattice.end()) return {};
    in_image[i] = cv::Point2d(corner->second.x(), corner->second.y());
  }
  return cv::Matx33d(cv::getPerspectiveTransform(on_square, in_image));
}

std::optional<Eigen::Vector2d> refine_prediction(const GreyImage& image,
                                                 const PredictedCorner& predicted) {
  const double side_px = predicted.min_side_px();
  if (!(side_px < image.width)) return {};
  const int radius_px = std::max(static_cast<int>(max_prediction_error * side_px), min_radius_px);
  return refine_saddle_point(image, predicted.at_px, radius_px, max_radius_px);
}

/// The corner after `cell`, if the image shows one there.
std::optional<Eigen::Vector2d> next_corner(const CornerLattice& lattice, const GreyImage& image,
                                           const LatticeCell& cell, const LatticeCell& step) {
  const auto predicted = predict_corner(lattice, cell, step);
  const auto known = squares_around(image, lattice, cell);
  if (!predicted || !known) return {};
  const auto corner = refine_prediction(image, *predicted);
  if (!corner) return {};
  const auto squares = CornerSquares::sample(image, *corner, predicted->x_px, predicted->y_px);
  const bool is_main_dark = known->is_main_dark();
  if (!squares || !(squares->contrast(!is_main_dark) > 0.5 * known->contrast(is_main_dark)))
    return {};
  return corner;
}

}  // namespace

std::optional<PredictedCorner> predict_corner(const CornerLattice& lattice, const LatticeCell& cell,
                                              const LatticeCell& step) {
  for (const int sign : {1, -1}) {
    const LatticeCell across{-sign * step[1], sign * step[0]};
    const auto h = square_homography(lattice, cell, step, across);
    if (!h) continue;
    const auto image_of = [&](double along, double sideways) {
      const cv::Vec3d p = *h * cv::Vec3d(along, sideways, 1.0);
      return Eigen::Vector2d(p[0] / p[2], p[1] / p[2]);
    };
    const Eigen::Vector2d at_px = image_of(1.0, 0.0);
    const Eigen::Vector2d along_px = at_px - lattice.at(cell);
    const Eigen::Vector2d across_px = image_of(1.0, 1.0) - at_px;
    return PredictedCorner{at_px, step[0] * along_px + across[0] * across_px,
                           step[1] * along_px + across[1] * across_px};
  }
  return {};
}

std::optional<CornerSquares> CornerSquares::sample(const GreyImage& image,
                                                   const Eigen::Vector2d& corner_px,
                                                   const Eigen::Vector2d& x_px,
                                                   const Eigen::Vector2d& y_px) {
  CornerSquares squares;
  for (int x : {-1, 1})
    for (int y : {-1, 1}) {
      const auto grey = mean_grey(image, corner_px + sampled_place * (x * x_px + y * y_px));
      if (!grey) return {};
      squares.grey_[x > 0][y > 0] = *grey;
    }
  return squares;
}

double CornerSquares::contrast(bool is_main_dark) const {
  const auto [main_min, main_max] = std::minmax({at(1, 1), at(-1, -1)});
  const auto [other_min, other_max] = std::minmax({at(1, -1), at(-1, 1)});
  return is_main_dark ? other_min - main_max : main_min - other_max;
}

std::optional<CornerSquares> squares_around(const GreyImage& image, const CornerLattice& lattice,
                                            const LatticeCell& cell) {
  const auto x_px = side_px(lattice, cell, {1, 0}), y_px = side_px(lattice, cell, {0, 1});
  if (!x_px || !y_px) return {};
  return CornerSquares::sample(image, lattice.at(cell), *x_px, *y_px);
}

bool is_unit_square(const CornerLattice& corners, const GreyImage& image) {
  const auto first = squares_around(image, corners, {0, 0});
  if (!first) return false;
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  for (const auto& [cell, corner_px] : corners) {
    const auto squares = squares_around(image, corners, cell);
    const bool is_main_dark = first->is_main_dark() == ((cell[0] + cell[1]) % 2 == 0);
    if (!squares || !(squares->contrast(is_main_dark) > 0.0)) return false;
    centre_px += 0.25 * corner_px;
  }
  const double middle = 0.5 * (first->at(1, 1) + first->at(1, -1));
  const auto grey = mean_grey(image, centre_px);
  return grey && (*grey < middle) == first->is_main_dark();
}

void grow(CornerLattice& lattice, const GreyImage& image) {
  for (std::size_t before = 0; before < lattice.size();) {
    before = lattice.size();
    for (const auto& [cell, unused] : CornerLattice(lattice))
      for (const LatticeCell& step : lattice_steps)
        if (!lattice.contains(cell + step))
          if (const auto corner = next_corner(lattice, image, cell, step))
            lattice[cell + step] = *corner;
  }
}

bool is_end_of_board(const CornerLattice& lattice, const GreyImage& image, const LatticeCell& cell,
                     const LatticeCell& step) {
  if (lattice.contains(cell + step)) return false;
  const auto predicted = predict_corner(lattice, cell, step);
  const auto known = squares_around(image, lattice, cell);
  if (!predicted || !known) return false;
  const auto squares =
      CornerSquares::sample(image, predicted->at_px, predicted->x_px, predicted->y_px);
  if (!squares) return false;
  const auto side = [&](int inwards, int across) {
    return step[0] != 0 ? squares->at(inwards * -step[0], across)
                        : squares->at(across, inwards * -step[1]);
  };
  const auto [dark, light] = std::minmax({side(1, 1), side(1, -1)});
  const double middle = 0.5 * (dark + light);
  return light - dark > 0.5 * known->contrast(known->is_main_dark()) && side(-1, 1) > middle &&
         side(-1, -1) > middle;
}

}  // namespace touchtrace
