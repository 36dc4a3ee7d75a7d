// Prints the tracks that `touchtrace-verify labels` smooths with their truth and the smoothed
// result, so that other smoothers can be compared on the same data:
//
//   smoothing_tracks wave|throw|pingpong
//
// prints {"cpu_s", "clips": [{"time_s" [frames], "position_m", "true_velocity_m_per_s",
// "velocity_m_per_s" [frames, 3], "landings_s"}...]}; cpu_s: CPU time of smoothing.
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/base/provenance.h"
#include "tests/verify/calib/smoothing_sample.h"

using namespace touchtrace;

namespace {

nlohmann::json row(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json clip(const SyntheticMotion& motion, const Track& track,
                    const SmoothedTrack& smoothed) {
  nlohmann::json result;
  for (const auto& point : track) {
    result["time_s"].push_back(point.time_s);
    result["position_m"].push_back(row(point.position_m));
    result["true_velocity_m_per_s"].push_back(row(motion.velocity_at(point.time_s)));
    result["velocity_m_per_s"].push_back(row(smoothed.smoothed(point.time_s).velocity_m_per_s));
  }
  result["landings_s"] = nlohmann::json::array();
  for (const auto& flight : motion.flights) result["landings_s"].push_back(flight.landing_s);
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string, SyntheticMotion (*)(double, std::uint64_t)> activities{
      {"wave", synthetic_wave}, {"throw", synthetic_throw}, {"pingpong", synthetic_pingpong}};
  const auto activity = activities.find(argc == 2 ? argv[1] : "");
  if (activity == activities.end()) {
    std::fputs("usage: smoothing_tracks wave|throw|pingpong\n", stderr);
    return 2;
  }
  const auto data = smoothing_sample(activity->second);
  const Stopwatch stopwatch;
  const auto smoothed = smooth(data.tracks, data.flights, {});
  nlohmann::json result{{"cpu_s", stopwatch.cpu_seconds()}, {"clips", nlohmann::json::array()}};
  for (std::size_t i = 0; i < data.tracks.size(); ++i)
    result["clips"].push_back(clip(data.motions[i], data.tracks[i], smoothed.tracks[i]));
  std::puts(result.dump().c_str());
}
