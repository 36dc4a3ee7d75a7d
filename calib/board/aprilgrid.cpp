#include "calib/board/aprilgrid.h"

#include <fmt/core.h>

#include <Eigen/SVD>
#include <algorithm>
#include <map>
#include <opencv2/aruco.hpp>

#include "calib/board/corner_lattice.h"
#include "calib/board/local_homography.h"
#include "calib/board/saddle.h"
#include "calib/board/upscaled_image.h"
#include "engine/base/error.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr int num_tags_36h11 = 587, bits_per_side = 6;
constexpr int border_bits[] = {2, 1};  ///< kalibr's, the AprilTag library's
constexpr int min_radius_px = 3, max_radius_px = 10;

Eigen::Vector2d place_m(const CalibrationTarget& target, int column, int row) {
  return target.square_m * Eigen::Vector2d(column / 2, row / 2) +
         target.markers->side_m * Eigen::Vector2d(column % 2, row % 2);
}

void validate(const CalibrationTarget& target) {
  const int tags = target.num_corners() / 4;
  if (tags > num_tags_36h11)
    throw usage_error(fmt::format("an AprilGrid of {}x{} needs {} tags; 36h11 has {}",
                                  target.columns / 2, target.rows / 2, tags, num_tags_36h11),
                      "--columns and --rows count tags");
  if (!(target.markers->side_m < target.square_m))
    throw usage_error("there is no space between the tags of the AprilGrid",
                      "--tag-spacing is the space between tags over their side, e.g. 0.3");
}

/// Corners of decoded tags, by index; nullopt for a tag that the image shows twice.
using TagCorners = std::map<int, std::optional<Eigen::Vector2d>>;

TagCorners decode_tags(const GreyImage& image, const CalibrationTarget& target, int border) {
  const UpscaledImage enlarged(image, default_upscale_factor(image));
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = border;
  std::vector<std::vector<cv::Point2f>> tags;
  std::vector<int> tag_ids;
  try {
    cv::aruco::detectMarkers(enlarged.pixels,
                             cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11),
                             tags, tag_ids, parameters);
  } catch (const cv::Exception&) {
    return {};  // thrown for some images without a tag
  }
  // OpenCV begins with the corner that is the lower right one in kalibr's print, and is clockwise.
  constexpr std::array<LatticeCell, 4> tag_cells{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
  TagCorners corners;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (tag_ids[i] >= target.num_corners() / 4) continue;
    const int tag_column = tag_ids[i] % (target.columns / 2),
              tag_row = target.rows / 2 - 1 - tag_ids[i] / (target.columns / 2);
    for (std::size_t k = 0; k < 4; ++k) {
      const int id =
          (2 * tag_row + tag_cells[k][1]) * target.columns + 2 * tag_column + tag_cells[k][0];
      const bool is_first = !corners.contains(id);
      corners[id] = is_first ? std::optional(enlarged.to_original(tags[i][k])) : std::nullopt;
    }
  }
  return corners;
}

/// Refines corners and looks for further ones.
class CornerSearch {
 public:
  CornerSearch(const GreyImage& image, const CalibrationTarget& target, int border,
               const TargetCorners& rough)
      : image_(image), target_(target), found_(rough) {
    const double side_m = target.markers->side_m;
    square_m_ = std::min(target.square_m - side_m, side_m * border / (bits_per_side + 2 * border));
    refine_decoded();
  }

  TargetCorners find_all() {
    const double min_contrast = 0.5 * median_contrast();
    for (std::size_t before = 0; before < found_.second.size();) {
      before = found_.second.size();
      for (int id = 0; id < target_.num_corners(); ++id)
        if (std::ranges::find(found_.second, id) == found_.second.end())
          if (const auto corner = predicted_corner(id, min_contrast)) add(id, *corner);
    }
    return found_;
  }

 private:
  void add(int id, const Eigen::Vector2d& corner_px) {
    found_.first.push_back(corner_px);
    found_.second.push_back(id);
  }
  /// Starts from the decoded corner or, if that is too far off, from where the others predict it.
  void refine_decoded() {
    const TargetCorners rough = std::exchange(found_, {});
    for (std::size_t i = 0; i < rough.second.size(); ++i) {
      const int id = rough.second[i];
      const auto local = homography(rough, id);
      if (!local) continue;
      auto corner = refine(rough.first[i], *local, id);
      if (!corner) corner = refine(local->image_of(target_.corner_m(id).head<2>()), *local, id);
      if (corner) add(id, *corner);
    }
  }
  std::optional<LocalHomography> homography(const TargetCorners& known, int id) const {
    return LocalHomography::fit(known, target_, target_.corner_m(id).head<2>());
  }
  std::optional<Eigen::Vector2d> refine(const Eigen::Vector2d& start_px,
                                        const LocalHomography& local, int id) const {
    const Eigen::Matrix2d px_per_m = local.derivative(target_.corner_m(id).head<2>());
    const double radius_px =
        square_m_ * Eigen::JacobiSVD<Eigen::Matrix2d>(px_per_m).singularValues()[1];
    if (!(radius_px < image_.width)) return {};
    return refine_saddle_point(
        image_, start_px, std::clamp(static_cast<int>(radius_px), min_radius_px, max_radius_px));
  }
  /// Contrast of the tag's border and the black square, which touch in a corner, to the white
  /// around.
  std::optional<double> contrast(const Eigen::Vector2d& corner_px, const LocalHomography& local,
                                 int id) const {
    const Eigen::Matrix2d sides_px =
        2.0 * square_m_ * local.derivative(target_.corner_m(id).head<2>());
    const auto squares = CornerSquares::sample(image_, corner_px, sides_px.col(0), sides_px.col(1));
    if (!squares) return {};
    return squares->contrast((id % target_.columns + id / target_.columns) % 2 == 0);
  }
  double median_contrast() const {
    std::vector<double> contrasts;
    for (std::size_t i = 0; i < found_.second.size(); ++i)
      if (const auto local = homography(found_, found_.second[i]))
        if (const auto c = contrast(found_.first[i], *local, found_.second[i]))
          contrasts.push_back(*c);
    return contrasts.empty() ? 0.0 : median(std::move(contrasts));
  }
  std::optional<Eigen::Vector2d> predicted_corner(int id, double min_contrast) const {
    const auto local = homography(found_, id);
    if (!local) return {};
    const auto corner = refine(local->image_of(target_.corner_m(id).head<2>()), *local, id);
    if (!corner) return {};
    const auto c = contrast(*corner, *local, id);
    return c && *c > min_contrast ? corner : std::nullopt;
  }

  const GreyImage& image_;
  const CalibrationTarget& target_;
  TargetCorners found_;
  double square_m_;  ///< side of the largest squares around a corner that have one colour
};

}  // namespace

TargetCorners find_aprilgrid_corners(const GreyImage& image, const CalibrationTarget& target) {
  validate(target);
  for (const int border : border_bits) {
    TargetCorners decoded;
    for (const auto& [id, corner] : decode_tags(image, target, border))
      if (corner) decoded.first.push_back(*corner), decoded.second.push_back(id);
    if (!determine_pose(decoded.second, target)) continue;
    TargetCorners found = CornerSearch(image, target, border, decoded).find_all();
    if (determine_pose(found.second, target)) return found;
  }
  return {};
}

const TargetKind aprilgrid_kind{
    "aprilgrid", place_m, [](const CalibrationTarget&) { return false; }, find_aprilgrid_corners};

}  // namespace touchtrace
