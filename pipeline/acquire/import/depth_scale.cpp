#include "pipeline/acquire/import/depth_scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/statistics.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {
namespace {

constexpr double float_unit_m = 0.00025;
constexpr std::size_t num_sampled = 9;

struct Range {
  double min, max;
  bool contains(double value) const { return value >= min && value <= max; }
};

/// Median depth of images for hand and object, and of any camera.
constexpr Range usual_m{0.1, 20.0};
constexpr Range possible_m{0.02, 100.0};
constexpr double far_m = 6.0;  // few scenes of a hand have a larger median

/// Counts of up to nine images, of pixels that have one; nullopt if none of them can be read.
std::optional<std::vector<std::uint16_t>> sample_counts(const DepthScale& scale,
                                                        const SourceStream& depth) {
  std::optional<std::vector<std::uint16_t>> counts;
  const std::size_t step = std::max<std::size_t>(1, depth.images.size() / num_sampled);
  for (std::size_t i = step / 2; i < depth.images.size(); i += step) try {
      const auto image = scale.counts(depth.read(i));
      if (!counts) counts.emplace();
      std::ranges::copy_if(image, std::back_inserter(*counts),
                           [](auto count) { return count > 0; });
    } catch (const std::exception&) {
      continue;  // named when it is imported
    }
  return counts;
}

/// ": 1000 (median 0.72 m) or 5000 (median 0.14 m)": scales that make the median plausible.
std::string proposed_scales(double count) {
  std::string list;
  for (const char* scale : {"100", "1000", "5000", "10000"})
    if (usual_m.contains(count / std::stod(scale)))
      list += fmt::format("{}{} (median {:.2f} m)", list.empty() ? ": " : " or ", scale,
                          count / std::stod(scale));
  return list;
}

/// Depth images of the TUM benchmark are millimetres times 5. Others in its format often are
/// millimetres.
bool may_be_millimetres(const std::vector<std::uint16_t>& counts) {
  const auto multiples = std::ranges::count_if(counts, [](auto count) { return count % 5 == 0; });
  return static_cast<double>(multiples) < 0.9 * static_cast<double>(counts.size());
}

}  // namespace

std::vector<std::uint16_t> DepthScale::counts(const cv::Mat& depth) const {
  CV_Assert(depth.channels() == 1);
  cv::Mat scaled;
  depth.convertTo(scaled, CV_64F, counts_per_value);
  std::vector<std::uint16_t> result(scaled.total());
  std::transform(scaled.begin<double>(), scaled.end<double>(), result.begin(), [](double count) {
    const bool is_valid = count > 0.0 && count < std::numeric_limits<std::uint16_t>::max();
    return is_valid ? static_cast<std::uint16_t>(std::lround(count)) : std::uint16_t{0};
  });
  return result;
}

DepthScale depth_scale(const ImportSource& source, int type, double values_per_m) {
  if (type == CV_32FC1)
    return {float_unit_m, 1.0 / (float_unit_m * (values_per_m > 0.0 ? values_per_m : 1.0))};
  return {1.0 / (values_per_m > 0.0 ? values_per_m : source.counts_per_m), 1.0};
}

void require_plausible(const DepthScale& scale, const SourceStream& depth, bool is_given) {
  const auto sampled = sample_counts(scale, depth);
  if (!sampled) return;
  const auto& counts = *sampled;
  if (counts.empty())
    throw data_error(fmt::format("the depth images have no measurement from 0 to {:.3g} m",
                                 std::numeric_limits<std::uint16_t>::max() * scale.unit_m),
                     "if it is floating-point depth in millimetres, give --depth-scale 1000");
  const double median_count = median({counts.begin(), counts.end()}), per_m = 1.0 / scale.unit_m;
  const auto hint =
      fmt::format("--depth-scale gives the counts per metre{}", proposed_scales(median_count));
  if (!(is_given ? possible_m : usual_m).contains(median_count / per_m))
    throw data_error(fmt::format("at {:g} counts per metre the median depth would be {:.3g} m, "
                                 "which is implausible",
                                 per_m, median_count / per_m),
                     hint);
  if (!is_given && median_count / per_m > far_m)
    Progress::warn(fmt::format("at {:g} counts per metre the median depth is {:.3g} m; {}", per_m,
                               median_count / per_m, hint));
  if (!is_given && std::lround(per_m) == std::lround(tum_counts_per_m) &&
      may_be_millimetres(counts))
    throw data_error(
        "the depth may be in millimetres: counts of the TUM format are multiples of "
        "5, these are not",
        hint);
}

}  // namespace touchtrace
