#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "pipeline/dataset/load.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {
namespace {

/// Clock errors can put labels at a clip's ends outside the samples by up to this.
constexpr double max_extrapolation_s = 0.1;

/// Time `after_s` after sample `sample`, whose interval is `period_s` long. Outside of [0,
/// period_s] before the clip's first and after its last sample.
struct SampleTime {
  std::size_t sample;
  double period_s, after_s;
};

SampleTime find_sample(const Truth& truth, int clip, double time_s) {
  const auto [begin, end] = std::equal_range(truth.clip.begin(), truth.clip.end(), clip);
  const auto first = truth.time_s.begin() + (begin - truth.clip.begin());
  const auto last = truth.time_s.begin() + (end - truth.clip.begin());
  if (last - first < 2 ||
      !(*first - max_extrapolation_s <= time_s && time_s <= *(last - 1) + max_extrapolation_s))
    throw data_error(fmt::format("no truth at {:.3f} s of clip {}", time_s, clip),
                     "evaluate against the labels instead");
  const auto later = std::clamp(std::upper_bound(first, last, time_s), first + 1, last - 1);
  return {static_cast<std::size_t>(later - 1 - truth.time_s.begin()), *later - *(later - 1),
          time_s - *(later - 1)};
}

/// Position and velocity along one axis.
struct Motion {
  double position, velocity;

  Motion after(double seconds) const { return {position + seconds * velocity, velocity}; }
};

Motion interpolated(const Motion& start, const Motion& end, const SampleTime& at) {
  const double h = at.period_s, u = at.after_s / h;
  if (u < 0.0) return start.after(at.after_s);
  if (u > 1.0) return end.after(at.after_s - h);
  return {start.position + u * u * (3 - 2 * u) * (end.position - start.position) +
              h * u * (1 - u) * ((1 - u) * start.velocity - u * end.velocity),
          (1 - u) * start.velocity + u * end.velocity};
}

/// Writes position and velocity of `body` to state[first .. first + 5].
void interpolate(const Truth::Body& body, const SampleTime& at, std::size_t first, State& state) {
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t i = 3 * at.sample + d, j = i + 3;
    const Motion motion = interpolated({body.position_m[i], body.velocity_m_per_s[i]},
                                       {body.position_m[j], body.velocity_m_per_s[j]}, at);
    state[first + d] = static_cast<float>(motion.position);
    state[first + 3 + d] = static_cast<float>(motion.velocity);
  }
}

}  // namespace

void attach_truth(Dataset& dataset, const std::vector<LabelledRecording>& sources) {
  dataset.truth.assign(dataset.label.size(), State{});
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Truth truth = read_truth(sources[i].recording);
    for (const auto& sequence : dataset.sequences) {
      if (sequence.recording != static_cast<int>(i)) continue;
      for (int frame = sequence.first_frame; frame < sequence.first_frame + sequence.frames;
           ++frame) {
        const SampleTime at = find_sample(truth, sequence.clip, dataset.time_s[frame]);
        interpolate(truth.object, at, 0, dataset.truth[frame]);
        interpolate(truth.hand, at, 6, dataset.truth[frame]);
      }
    }
  }
}

}  // namespace touchtrace
