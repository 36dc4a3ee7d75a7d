#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/features2d.hpp>

#include "calib/board/circle_image.h"
#include "calib/board/circle_lattice.h"
#include "calib/board/upscaled_image.h"
#include "calib/matrix/decomposition.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr int num_refinements = 2;
/// Radius below which most pixels of a circle are on its edge, and weigh what they cover. In a
/// larger one only greys near the middle between dark and light weigh less than 1: reflections in
/// the circle do not count.
constexpr double small_radius_px = 15.0;
constexpr float darkest_threshold = 10.0f;  ///< [grey levels] for circles on a dim board

Eigen::Vector2d asymmetric_place_m(const CalibrationTarget& target, int column, int row) {
  return target.square_m * Eigen::Vector2d(2 * column + row % 2, row);
}

/// Half the distance of neighbouring circles.
double free_radius_m(const CalibrationTarget& target) {
  const double distance = target.kind == &asymmetric_circles_kind ? std::numbers::sqrt2 : 1.0;
  return 0.5 * distance * target.square_m;
}

/// Centres of dark blobs. The default detector is limited to 5000 pixels and to well lit boards;
/// here a blob may be as large as its share of the image.
std::vector<Eigen::Vector2d> detect_blobs(const GreyImage& image, const CalibrationTarget& target) {
  const UpscaledImage enlarged(image, default_upscale_factor(image));
  cv::SimpleBlobDetector::Params parameters;
  parameters.minThreshold = darkest_threshold;
  parameters.maxArea = static_cast<float>(enlarged.pixels.total()) / float(target.num_corners());
  std::vector<cv::KeyPoint> blobs;
  cv::SimpleBlobDetector::create(parameters)->detect(enlarged.pixels, blobs);
  std::vector<Eigen::Vector2d> centres;
  for (const cv::KeyPoint& blob : blobs) centres.push_back(enlarged.to_original(blob.pt));
  return centres;
}

/// Pixels of a circle and its surroundings up to half the distance of its neighbours.
class CirclePixels {
 public:
  CirclePixels(const GreyImage& image, const CircleImage& circle, const Eigen::Vector2d& centre_m,
               double free_radius_m)
      : centre_px_(circle.image_of(centre_m)),
        free_radius_m_(free_radius_m),
        px2_per_m2_(std::abs(circle.derivative().determinant())) {
    Eigen::Array2d first_px = centre_px_, last_px = centre_px_;
    for (const auto& point : circle.boundary_px(free_radius_m))
      first_px = first_px.min(point.array()), last_px = last_px.max(point.array());
    if (!((first_px >= 0.0).all() && last_px.x() < image.width - 1.0 &&
          last_px.y() < image.height - 1.0))
      return;
    for (int v = int(first_px.y()); v <= last_px.y() + 1.0; ++v)
      for (int u = int(first_px.x()); u <= last_px.x() + 1.0; ++u) {
        const Eigen::Vector2d pixel(u, v);
        const double radius = (circle.place_of(pixel) - centre_m).norm() / free_radius_m;
        if (radius < 1.0)
          pixels_.push_back(
              {radius, pixel - centre_px_, double(image.pixels[std::size_t(v * image.width + u)])});
      }
  }
  bool are_in_image() const { return !pixels_.empty(); }
  /// Radius of the circle [m] by its area; NaN if it is not darker than its surroundings.
  double radius_m() const {
    const double dark = mean_grey(0.0, 0.2), light = mean_grey(0.8, 1.0);
    double area_px2 = 0.0;
    each(0.0, 1.0, [&](const Eigen::Vector2d&, double grey) {
      area_px2 += std::clamp((light - grey) / (light - dark), 0.0, 1.0);
    });
    return light > dark ? std::sqrt(area_px2 / px2_per_m2_ / std::numbers::pi) : std::nan("");
  }
  /// Centroid of the area that is darker than half way to a plane fitted to the surroundings.
  Eigen::Vector2d centroid_px(double radius_m) const {
    const double border = 0.5 * (radius_m / free_radius_m_ + 1.0), dark = mean_grey(0.0, 0.2);
    const double steepness = std::sqrt(px2_per_m2_) * radius_m < small_radius_px ? 1.0 : 2.0;
    const Eigen::Vector3d plane = surroundings(border);
    double sum = 0.0;
    Eigen::Vector2d moment = Eigen::Vector2d::Zero();
    each(0.0, border, [&](const Eigen::Vector2d& offset_px, double grey) {
      const double light = plane.dot(Eigen::Vector3d(offset_px.x(), offset_px.y(), 1.0));
      const double darkness = (light - grey) / (light - dark);
      const double weight = std::clamp(0.5 + steepness * (darkness - 0.5), 0.0, 1.0);
      sum += weight, moment += weight * offset_px;
    });
    return centre_px_ + moment / sum;
  }

 private:
  struct Pixel {
    double radius;  ///< on the target, as a fraction of the free radius
    Eigen::Vector2d offset_px;
    double grey;
  };

  /// Calls visit(offset_px, grey) for pixels in a ring.
  template <class Visit>
  void each(double inner, double outer, Visit&& visit) const {
    for (const auto& [radius, offset_px, grey] : pixels_)
      if (radius >= inner && radius < outer) visit(offset_px, grey);
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
    return solve_semidefinite(normal, right);
  }

  Eigen::Vector2d centre_px_;
  double free_radius_m_, px2_per_m2_;
  std::vector<Pixel> pixels_;
};

/// Centroids less their offset from the centre's image; unchanged if they cannot be measured.
void refine_centres(const GreyImage& image, const CalibrationTarget& target,
                    TargetCorners& centres) {
  std::vector<std::pair<std::size_t, CirclePixels>> measurable;
  std::vector<std::optional<CircleImage>> circles(centres.corners_px.size());
  std::vector<double> radii_m;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const Eigen::Vector2d centre_m = target.corner_m(centres.ids[i]).head<2>();
    circles[i] = CircleImage::fit(centres, target, centre_m);
    if (!circles[i]) continue;
    const CirclePixels pixels(image, *circles[i], centre_m, free_radius_m(target));
    if (!pixels.are_in_image()) continue;
    measurable.emplace_back(i, pixels);
    if (const double radius_m = pixels.radius_m(); std::isfinite(radius_m))
      radii_m.push_back(radius_m);
  }
  if (radii_m.empty()) return;
  const double radius_m = median(std::move(radii_m));
  for (const auto& [i, pixels] : measurable) {
    const Eigen::Vector2d centre_px =
        pixels.centroid_px(radius_m) - circles[i]->centroid_offset_px(radius_m);
    if (centre_px.allFinite()) centres.corners_px[i] = centre_px;
  }
}

TargetCorners find_dark_circles(const GreyImage& image, const CalibrationTarget& target) {
  TargetCorners centres{order_circles(detect_blobs(image, target), target), {}};
  if (centres.corners_px.empty()) return {};
  centres.ids.resize(centres.corners_px.size());
  std::iota(centres.ids.begin(), centres.ids.end(), 0);
  for (int i = 0; i < num_refinements; ++i) refine_centres(image, target, centres);
  return {centres.corners_px, {}};
}

GreyImage negative(GreyImage image) {
  for (auto& grey : image.pixels) grey = static_cast<std::uint8_t>(~grey);
  return image;
}

/// Returns the centres of all circles of a symmetric or asymmetric grid, dark on a light board or
/// light on a dark one, laid out and numbered as for cv::findCirclesGrid; empty if not all are
/// visible. That function finds few tilted views of a symmetric grid, and with CALIB_CB_CLUSTERING
/// numbers some wrongly; order_circles() replaces it.
///
/// Each centre is the centroid of the circle's contrast, less the offset between the centre of an
/// ellipse and the image of the circle's centre: in a view tilted by 50 degrees this is 0.24 px for
/// circles of 30 px. The radius is estimated from the image. The offset is that of perspective;
/// lens distortion within a circle is neglected.
TargetCorners find_circle_centres(const GreyImage& image, const CalibrationTarget& target) {
  const TargetCorners dark = find_dark_circles(image, target);
  return dark.corners_px.empty() ? find_dark_circles(negative(image), target) : dark;
}

}  // namespace

const TargetKind circles_kind{
    .name = "circles",
    .element = "circles",
    .element_corners = 1,
    .place_m = square_lattice_m,
    .is_symmetric = [](const CalibrationTarget&) { return true; },
    .find_corners = find_circle_centres,
};

const TargetKind asymmetric_circles_kind{
    .name = "asymmetric-circles",
    .element = "circles",
    .element_corners = 1,
    .place_m = asymmetric_place_m,
    .is_symmetric = [](const CalibrationTarget& target) { return target.rows % 2 == 0; },
    .find_corners = find_circle_centres,
};

}  // namespace touchtrace
