#include "pipeline/export/tum_trajectory.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/files.h"

namespace touchtrace {
namespace {

std::string tum_trajectory(const Labels& labels, const LabelledBody& body, double epoch_unix_s) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (std::size_t i = 0; i < labels.time_s.size(); ++i) {
    const double* p = &body.position_m[3 * i];
    if ((body.quality[i] & (quality_lost | quality_gap)) != 0 || !std::isfinite(p[0] + p[1] + p[2]))
      continue;
    text += fmt::format("{:.6f} {:.9g} {:.9g} {:.9g} 0 0 0 1\n", epoch_unix_s + labels.time_s[i],
                        p[0], p[1], p[2]);
  }
  return text;
}

}  // namespace

std::array<std::filesystem::path, 2> tum_trajectory_files(const std::filesystem::path& folder) {
  return {folder / "hand.txt", folder / "object.txt"};
}

void write_tum_trajectories(const std::filesystem::path& folder, const Labels& labels,
                            double epoch_unix_s, bool overwrite) {
  const auto [hand, object] = tum_trajectory_files(folder);
  write_file(hand, tum_trajectory(labels, labels.hand, epoch_unix_s), overwrite);
  write_file(object, tum_trajectory(labels, labels.object, epoch_unix_s), overwrite);
}

}  // namespace touchtrace
