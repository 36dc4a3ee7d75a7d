#include "calib/board/aprilgrid.h"

#include <fmt/core.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "calib/board/corner_lattice.h"
#include "calib/board/local_homography.h"
#include "calib/board/markers.h"
#include "calib/board/saddle.h"
#include "engine/base/error.h"
#include "engine/base/statistics.h"

namespace touchtrace {
namespace {

constexpr int num_tags_36h11 = 587, bits_per_side = 6;
constexpr int border_bits[] = {2, 1};  ///< kalibr's, the AprilTag library's
constexpr int max_tags_in_row = 24, min_pairs_of_other = 3;
constexpr int min_radius_px = 3, max_radius_px = 10;
constexpr std::size_t min_pairs_for_spacing = 20;
/// Relative. Public photographs of two kalibr targets, one by a fisheye, show 0.301 and 0.302 for
/// 0.3.
constexpr double max_spacing_error = 0.05;

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

/// Decodes the tags of a grid. OpenCV begins with the corner that is the lower right one in
/// kalibr's print.
DecodedMarkers decode_tags(const GreyImage& image, int border) {
  DecodedMarkers tags = decode_markers(image, "apriltag_36h11", border);
  for (auto& corners_px : tags.corners_px) std::ranges::rotate(corners_px, corners_px.begin() + 2);
  return tags;
}

TargetCorners corners_of(const DecodedMarkers& tags, const CalibrationTarget& target) {
  constexpr std::array<LatticeCell, 4> tag_cells{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  TargetCorners corners;
  for (std::size_t i = 0; i < tags.ids.size(); ++i) {
    if (tags.ids[i] >= target.num_corners() / 4) continue;
    const int tag_column = tags.ids[i] % (target.columns / 2),
              tag_row = target.rows / 2 - 1 - tags.ids[i] / (target.columns / 2);
    for (std::size_t k = 0; k < 4; ++k) {
      corners.first.push_back(tags.corners_px[i][k]);
      corners.second.push_back((2 * tag_row + tag_cells[k][1]) * target.columns + 2 * tag_column +
                               tag_cells[k][0]);
    }
  }
  return corners;
}

/// Decoded tags one above the other in a grid with so many tags in a row.
struct TagPairs {
  int in_row = 0, all = 0;
  int right = 0;  ///< those that lie so in the image

  bool agree() const { return 2 * right >= all; }
};

TagPairs pairs_in_columns(const DecodedMarkers& tags, int in_row, const CalibrationTarget& target) {
  const Eigen::Vector2d above(0.0, -target.square_m / target.markers->side_m);
  TagPairs pairs{in_row};
  for (std::size_t i = 0; i < tags.ids.size(); ++i)
    if (const auto* other = tags.find(tags.ids[i] + in_row)) {
      ++pairs.all;
      if (homography_of({&tags.corners_px[i], {0.0, 0.0}}, {other, above})) ++pairs.right;
    }
  return pairs;
}

std::optional<OtherTarget> find_other(const GreyImage& image, const CalibrationTarget& asked) {
  TagPairs best;
  for (const int border : border_bits) {
    const DecodedMarkers tags = decode_tags(image, border);
    for (int in_row = 2; in_row <= max_tags_in_row; ++in_row)
      if (const TagPairs pairs = pairs_in_columns(tags, in_row, asked); pairs.right > best.right)
        best = pairs;
  }
  if (best.right < min_pairs_of_other || !best.agree() || best.in_row == asked.columns / 2)
    return {};
  return OtherTarget{fmt::format("no AprilGrid with {} tags in a row but one with {}",
                                 asked.columns / 2, best.in_row),
                     fmt::format("give --columns {}; --rows counts tags, too", best.in_row)};
}

/// Space between two tags in a row over their side, from their corners along a line: `corners_px`
/// at 0, 1, 1 + s and 2 + s. Their cross ratio is the same in each perspective. NaN if they cannot
/// be such corners.
double spacing_of(const std::array<Eigen::Vector2d, 4>& corners_px) {
  const auto distance = [&](std::size_t i, std::size_t k) {
    return (corners_px[k] - corners_px[i]).norm();
  };
  const double cross_ratio = distance(0, 2) * distance(1, 3) / (distance(1, 2) * distance(0, 3));
  return std::sqrt(cross_ratio / (cross_ratio - 1.0)) - 1.0;
}

void add_spacings(const BoardView& view, const CalibrationTarget& target,
                  std::vector<double>& spacings) {
  std::vector<const Eigen::Vector2d*> corners(static_cast<std::size_t>(target.num_corners()));
  for (std::size_t i = 0; i < view.corners_px.size(); ++i)
    corners[static_cast<std::size_t>(view.corner_id(i))] = &view.corners_px[i];
  for (int first = 0; first < target.num_corners(); first += 2) {
    if (first % target.columns + 4 > target.columns) continue;
    const auto tags = std::span(corners).subspan(static_cast<std::size_t>(first), 4);
    if (std::ranges::find(tags, nullptr) != tags.end()) continue;
    if (const double s = spacing_of({*tags[0], *tags[1], *tags[2], *tags[3]}); std::isfinite(s))
      spacings.push_back(s);
  }
}

std::optional<OtherTarget> find_other_proportions(const std::vector<BoardView>& views,
                                                  const CalibrationTarget& asked) {
  std::vector<double> spacings;
  for (const auto& view : views) add_spacings(view, asked, spacings);
  if (spacings.size() < min_pairs_for_spacing) return {};
  const double seen = median(std::move(spacings)),
               given = asked.square_m / asked.markers->side_m - 1.0;
  if (!(std::abs(seen - given) > max_spacing_error * given)) return {};
  return OtherTarget{
      fmt::format("an AprilGrid with a space between tags of {:.3g} of their side, not {:.3g}",
                  seen, given),
      fmt::format("measure both, and give about --tag-spacing {:.2g}", seen)};
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
    const DecodedMarkers tags = decode_tags(image, border);
    const TargetCorners decoded = corners_of(tags, target);
    if (!pairs_in_columns(tags, target.columns / 2, target).agree() ||
        !determine_pose(decoded.second, target))
      continue;
    TargetCorners found = CornerSearch(image, target, border, decoded).find_all();
    if (determine_pose(found.second, target)) return found;
  }
  return {};
}

const TargetKind aprilgrid_kind{"aprilgrid",
                                "tags",
                                2,
                                place_m,
                                [](const CalibrationTarget&) { return false; },
                                find_aprilgrid_corners,
                                find_other,
                                find_other_proportions};

}  // namespace touchtrace
