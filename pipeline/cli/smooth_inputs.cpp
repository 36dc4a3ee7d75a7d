#include "pipeline/cli/smooth_inputs.h"

#include <fmt/core.h>

#include <utility>

#include "engine/base/error.h"
#include "engine/base/progress.h"

namespace touchtrace::cli {
namespace {

/// Sets the standard deviations if the file has none. Returns their source.
std::string set_sigmas(TrackFile& file, double sigma_m) {
  if (file.has_sigmas) return "file";
  const Eigen::Vector3d sigma =
      sigma_m > 0.0 ? Eigen::Vector3d::Constant(sigma_m) : estimate_white_sigma(file.track);
  if (sigma.hasNaN())
    throw data_error(fmt::format("the standard deviation of {} cannot be estimated from its {} "
                                 "samples",
                                 file.file.string(), file.track.size()),
                     "give --sigma METRES");
  for (auto& point : file.track) point.sigma_m = sigma;
  return sigma_m > 0.0 ? "option" : "data";
}

}  // namespace

std::vector<SmoothInput> read_smooth_inputs(const std::vector<std::string>& paths,
                                            const std::vector<SmoothedFiles>& files,
                                            double sigma_m) {
  std::vector<SmoothInput> inputs;
  Progress progress("reading tracks", paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    TrackFile track = read_track(paths[i]);
    const auto source = set_sigmas(track, sigma_m);
    inputs.push_back({std::move(track), files[i], source});
    progress.advance();
  }
  return inputs;
}

}  // namespace touchtrace::cli
