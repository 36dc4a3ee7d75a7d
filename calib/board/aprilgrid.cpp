#include <fmt/core.h>

#include <Eigen/SVD>
#include <algorithm>
#include <optional>

#include "calib/board/corner_lattice.h"
#include "calib/board/local_homography.h"
#include "calib/board/saddle.h"
#include "calib/board/tag_grid.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr const char* dictionary = "apriltag_36h11";
constexpr int bits_per_side = 6;
constexpr int border_bits[] = {2, 1};  ///< kalibr's, the AprilTag library's
constexpr int min_radius_px = 3, max_radius_px = 10;

/// Decodes the tags of a grid. OpenCV begins with the corner that is the lower right one in
/// kalibr's print.
DecodedMarkers decode_tags(const GreyImage& image, int border) {
  DecodedMarkers tags = decode_markers(image, dictionary, border);
  for (auto& corners_px : tags.corners_px) std::ranges::rotate(corners_px, corners_px.begin() + 2);
  return tags;
}

std::optional<OtherTarget> find_other(const GreyImage& image, const CalibrationTarget& asked) {
  for (const int border : border_bits)
    if (const auto other =
            find_other_tag_columns(decode_tags(image, border), asked, FirstRow::bottom))
      return other;
  return {};
}

std::optional<OtherTarget> recognize(const GreyImage& image) {
  for (const int border : border_bits)
    if (const auto in_row = find_tags_in_row(decode_tags(image, border), FirstRow::bottom))
      return OtherTarget{
          fmt::format("an AprilGrid with {} tags in a row", *in_row),
          fmt::format("give --target aprilgrid --columns {}, and the number of --rows", *in_row)};
  return {};
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
    for (std::size_t before = 0; before < found_.ids.size();) {
      before = found_.ids.size();
      for (int id = 0; id < target_.num_corners(); ++id)
        if (std::ranges::find(found_.ids, id) == found_.ids.end())
          if (const auto corner = predicted_corner(id, min_contrast)) add(id, *corner);
    }
    return found_;
  }

 private:
  void add(int id, const Eigen::Vector2d& corner_px) {
    found_.corners_px.push_back(corner_px);
    found_.ids.push_back(id);
  }
  /// Starts from the decoded corner or, if that is too far off, from where the others predict it.
  void refine_decoded() {
    const TargetCorners rough = std::exchange(found_, {});
    for (std::size_t i = 0; i < rough.ids.size(); ++i) {
      const int id = rough.ids[i];
      const auto local = homography(rough, id);
      if (!local) continue;
      auto corner = refine(rough.corners_px[i], *local, id);
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
    for (std::size_t i = 0; i < found_.ids.size(); ++i)
      if (const auto local = homography(found_, found_.ids[i]))
        if (const auto c = contrast(found_.corners_px[i], *local, found_.ids[i]))
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

/// Returns the visible corners of kalibr's AprilGrid: tags 36h11, upright, numbered along the rows
/// from the lower left one, with black squares between their corners. Both are empty if they do
/// not determine a pose. Tags may have a border of two bits, as kalibr prints them, or of one.
///
/// The frame of the target has its origin at the upper left corner, x to the right, y down;
/// kalibr's is at the lower left, y up.
///
/// From the tags that OpenCV decodes, other corners are predicted by LocalHomography. A corner is
/// used if it is a saddle point with more than half the median contrast.
///
/// Throws usage_error for more tags than 36h11 has, or tags without space between them.
TargetCorners find_aprilgrid_corners(const GreyImage& image, const CalibrationTarget& target) {
  require_possible_tag_grid(target);
  for (const int border : border_bits) {
    const DecodedMarkers tags = decode_tags(image, border);
    const TargetCorners decoded = tag_corners(tags, target, FirstRow::bottom);
    if (!lie_as_in_grid(tags, target, FirstRow::bottom) || !can_determine_pose(decoded.ids, target))
      continue;
    TargetCorners found = CornerSearch(image, target, border, decoded).find_all();
    if (can_determine_pose(found.ids, target)) return found;
  }
  return {};
}

}  // namespace

const TargetKind aprilgrid_kind{
    .name = "aprilgrid",
    .element = "tags",
    .element_corners = 2,
    .dictionary = dictionary,
    .place_m = tag_corner_m,
    .is_symmetric = [](const CalibrationTarget&) { return false; },
    .find_corners = find_aprilgrid_corners,
    .find_other = find_other,
    .recognize = recognize,
    .find_other_proportions = find_other_tag_spacing,
};

}  // namespace touchtrace
