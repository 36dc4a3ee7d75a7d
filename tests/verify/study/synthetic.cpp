#include "tests/verify/study/synthetic.h"

#include <fmt/core.h>

#include <cmath>

#include "engine/base/random.h"

namespace touchtrace::study {
namespace {

constexpr double step_s = 1.0 / 15.0;
constexpr double stiffness_per_s2 = 30.0, damping_per_s = 2.0;
constexpr double force_sigma = 6.0;        // [m/s^2] of acceleration
constexpr double force_correlation = 0.8;  // from frame to frame

using Vector = std::array<double, 3>;

State state_of(const Vector& position, const Vector& velocity) {
  State state{};
  for (int axis = 0; axis < 3; ++axis) {
    state[axis] = static_cast<float>(position[axis] - (axis == 1 ? 0.05 : 0.0));
    state[6 + axis] = static_cast<float>(position[axis]);
    state[3 + axis] = state[9 + axis] = static_cast<float>(velocity[axis]);
  }
  return state;
}

/// Pressure pattern of an object; number 0 is the ball.
struct Grip {
  int number, objects;

  std::string name() const { return number == 0 ? "ball" : fmt::format("object {}", number); }
  double force_fraction() const { return 1.0 - 0.5 * number / objects; }
  double pressure(int col) const { return number > 0 && col % objects == number ? 0.2 : 0.0; }
};

void append_image(Dataset& data, const Vector& force, const Grip& grip, RandomStream& random) {
  for (int row = 0; row < data.rows; ++row)
    for (int col = 0; col < data.cols; ++col) {
      const double pressure = 0.5 + grip.pressure(col) +
                              0.15 * grip.force_fraction() *
                                  force[static_cast<std::size_t>(3 * row / data.rows)] /
                                  force_sigma;
      data.tactile.push_back(static_cast<float>(pressure + random.normal(0.0, 0.01)));
    }
}

void append_clip(Dataset& data, const SyntheticOptions& options, Split split, const Grip& grip,
                 RandomStream& random) {
  const double innovation = std::sqrt(1.0 - force_correlation * force_correlation) * force_sigma;
  data.sequences.push_back(
      {.first_frame = data.frames(),
       .frames = options.frames,
       .object = grip.name(),
       .split = split,
       .clip = static_cast<int>(data.sequences.size()),
       .fingerprints = {fmt::format("seed {}, clip {}", options.seed, data.sequences.size())}});
  Vector position{}, velocity{}, force{};
  for (int frame = 0; frame < options.frames; ++frame) {
    for (double& component : force)
      component = force_correlation * component + innovation * random.normal();
    data.label.push_back(state_of(position, velocity));
    append_image(data, force, grip, random);
    for (int axis = 0; axis < 3; ++axis) {
      velocity[axis] += step_s * (force[axis] - stiffness_per_s2 * position[axis] -
                                  damping_per_s * velocity[axis]);
      position[axis] += step_s * velocity[axis];
    }
  }
}

}  // namespace

Dataset synthetic_dataset(const SyntheticOptions& options) {
  RandomStream random(options.seed, "synthetic data set");
  Dataset data;
  data.activity = "wave";
  data.rows = options.rows;
  data.cols = options.cols;
  for (int clip = 0; clip < options.clips; ++clip) {
    const double fraction = (clip + 0.5) / options.clips;
    append_clip(data, options,
                fraction < 0.6     ? Split::train
                : fraction < 0.675 ? Split::validation
                : fraction < 0.75  ? Split::calibration
                                   : Split::evaluation,
                {clip % options.objects, options.objects}, random);
  }
  data.causal_label = data.truth = data.label;
  data.trusted.assign(data.label.size(), 1);
  return data;
}

}  // namespace touchtrace::study
