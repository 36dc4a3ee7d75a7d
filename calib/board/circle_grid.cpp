#include "calib/board/circle_grid.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/features2d.hpp>

#include "calib/board/circle_lattice.h"
#include "calib/board/local_homography.h"
#include "calib/board/upscaled_image.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr int num_refinements = 2;

Eigen::Vector2d asymmetric_place_m(const CalibrationTarget& target, int column, int row) {
  return target.square_m * Eigen::Vector2d(2 * column + row % 2, row);
}

/// Half the distance of neighbouring circles.
double free_radius_m(const CalibrationTarget& target) {
  const double distance = target.kind == &asymmetric_circles_kind ? std::numbers::sqrt2 : 1.0;
  return 0.5 * distance * target.square_m;
}

/// Centres of dark blobs. The default detector is limited to 5000 pixels; here a blob may be as
/// large as its share of the image.
std::vector<Eigen::Vector2d> detect_blobs(const GreyImage& image, const CalibrationTarget& target) {
  const UpscaledImage enlarged(image, default_upscale_factor(image));
  cv::SimpleBlobDetector::Params parameters;
  parameters.maxArea = static_cast<float>(enlarged.pixels.total()) / float(target.num_corners());
  std::vector<cv::KeyPoint> blobs;
  cv::SimpleBlobDetector::create(parameters)->detect(enlarged.pixels, blobs);
  std::vector<Eigen::Vector2d> centres;
  for (const cv::KeyPoint& blob : blobs) centres.push_back(enlarged.to_original(blob.pt));
  return centres;
}

/// Pixels around a circle. Distances are on the target, from the image of its centre.
class CirclePixels {
 public:
  CirclePixels(const GreyImage& image, const Eigen::Vector2d& centre_px,
               const Eigen::Matrix2d& px_per_m, double free_radius_m)
      : image_(image),
        m_per_px_(px_per_m.inverse()),
        centre_px_(centre_px),
        free_radius_m_(free_radius_m) {
    const Eigen::Array2d half_px = free_radius_m * px_per_m.rowwise().norm();
    const Eigen::Array2d first_px = centre_px.array() - half_px,
                         last_px = centre_px.array() + half_px;
    are_in_image_ = (first_px >= 0.0).all() && last_px.x() < image.width - 1.0 &&
                    last_px.y() < image.height - 1.0;
    if (!are_in_image_) return;
    first_ = first_px.floor().cast<int>();
    last_ = last_px.ceil().cast<int>();
  }
  bool are_in_image() const { return are_in_image_; }
  /// Radius of the circle [m] by its darkness; NaN if it is not darker than its surroundings.
  double radius_m() const {
    const double dark = mean_grey(0.0, 0.2), light = mean_grey(0.8, 1.0);
    double darkness = 0.0;
    each(0.0, 1.0, [&](const Eigen::Vector2d&, double grey) {
      darkness += std::clamp((light - grey) / (light - dark), 0.0, 1.0);
    });
    return light > dark ? std::sqrt(darkness * std::abs(m_per_px_.determinant()) / std::numbers::pi)
                        : std::nan("");
  }
  /// Centroid of the darkness below a plane fitted to the surroundings of the circle.
  Eigen::Vector2d centroid_px(double radius_m) const {
    const double border = 0.5 * (radius_m / free_radius_m_ + 1.0);
    const Eigen::Vector3d light = surroundings(border);
    double sum = 0.0;
    Eigen::Vector2d moment = Eigen::Vector2d::Zero();
    each(0.0, border, [&](const Eigen::Vector2d& offset_px, double grey) {
      const double darkness = light.dot(Eigen::Vector3d(offset_px.x(), offset_px.y(), 1.0)) - grey;
      sum += darkness, moment += darkness * offset_px;
    });
    return centre_px_ + moment / sum;
  }

 private:
  /// Calls visit(offset_px, grey) for pixels in a ring; radii are fractions of the free radius.
  template <class Visit>
  void each(double inner, double outer, Visit&& visit) const {
    for (int v = first_.y(); v <= last_.y(); ++v)
      for (int u = first_.x(); u <= last_.x(); ++u) {
        const Eigen::Vector2d offset_px = Eigen::Vector2d(u, v) - centre_px_;
        const double radius = (m_per_px_ * offset_px).norm() / free_radius_m_;
        if (radius >= inner && radius < outer)
          visit(offset_px, double(image_.pixels[std::size_t(v * image_.width + u)]));
      }
  }
  double mean_grey(double inner, double outer) const {
    double sum = 0.0;
    int count = 0;
    each(inner, outer, [&](const Eigen::Vector2d&, double grey) { sum += grey, ++count; });
    return sum / count;
  }
  /// Brightness as a x + b y + c.
  Eigen::Vector3d surroundings(double border) const {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    each(border, 1.0, [&](const Eigen::Vector2d& offset_px, double grey) {
      const Eigen::Vector3d terms(offset_px.x(), offset_px.y(), 1.0);
      normal += terms * terms.transpose(), right += grey * terms;
    });
    return normal.ldlt().solve(right);
  }

  const GreyImage& image_;
  Eigen::Matrix2d m_per_px_;
  Eigen::Vector2d centre_px_;
  double free_radius_m_;
  bool are_in_image_;
  Eigen::Vector2i first_, last_;
};

/// Centroids less the perspective offset; unchanged if they cannot be measured.
void refine_centres(const GreyImage& image, const CalibrationTarget& target,
                    TargetCorners& centres) {
  const TargetCorners rough = centres;
  const double free_m = free_radius_m(target);
  std::vector<double> radii_m;
  std::vector<std::optional<LocalHomography>> local;
  std::vector<Eigen::Vector2d> places_m;
  const auto pixels_of = [&](std::size_t i) {
    return CirclePixels(image, rough.first[i], local[i]->derivative(places_m[i]), free_m);
  };
  for (std::size_t i = 0; i < rough.first.size(); ++i) {
    places_m.push_back(target.corner_m(rough.second[i]).head<2>());
    local.push_back(LocalHomography::fit(rough, target, places_m[i]));
    if (local[i] && pixels_of(i).are_in_image()) radii_m.push_back(pixels_of(i).radius_m());
  }
  std::erase_if(radii_m, [](double radius) { return !std::isfinite(radius); });
  if (radii_m.empty()) return;
  const double radius_m = median(std::move(radii_m));
  for (std::size_t i = 0; i < rough.first.size(); ++i) {
    if (!local[i] || !pixels_of(i).are_in_image()) continue;
    const Eigen::Vector2d offset_px =
        local[i]->ellipse_centre(places_m[i], radius_m) - local[i]->image_of(places_m[i]);
    const Eigen::Vector2d centre_px = pixels_of(i).centroid_px(radius_m) - offset_px;
    if (centre_px.allFinite()) centres.first[i] = centre_px;
  }
}

}  // namespace

TargetCorners find_circle_centres(const GreyImage& image, const CalibrationTarget& target) {
  TargetCorners centres{order_circles(detect_blobs(image, target), target), {}};
  if (centres.first.empty()) return {};
  centres.second.resize(centres.first.size());
  std::iota(centres.second.begin(), centres.second.end(), 0);
  for (int i = 0; i < num_refinements; ++i) refine_centres(image, target, centres);
  return {centres.first, {}};
}

const TargetKind circles_kind{"circles", square_lattice_m,
                              [](const CalibrationTarget&) { return true; }, find_circle_centres};

const TargetKind asymmetric_circles_kind{
    "asymmetric-circles", asymmetric_place_m,
    [](const CalibrationTarget& target) { return target.rows % 2 == 0; }, find_circle_centres};

}  // namespace touchtrace
