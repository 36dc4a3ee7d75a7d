#include "pipeline/scene/simulate/oracle.h"

#include <algorithm>
#include <cmath>

#include "pipeline/scene/glove/glove.h"

namespace touchtrace::scene {
namespace {

using Vectors = std::vector<Eigen::Vector3d>;

constexpr double full_scale = 100.0;  // of a component [N, m/s^2]; larger ones are clipped
constexpr int oracle_bits = 16;

/// Index range of the samples of a frame period.
struct Period {
  std::size_t first, last;

  double seconds() const { return static_cast<double>(last - first) / sample_rate_hz; }
};

Period frame_period(const ClipMotion& motion, const GloveClock& clock, std::size_t frame) {
  const double end_s = clock.first_frame_s +
                       static_cast<double>(motion.glove.sequence[frame]) / clock.rate_hz +
                       motion.glove.info.scan_s;
  const auto index = [&](double time_s) {
    const double samples = std::round((time_s - motion.samples.front().time_s) * sample_rate_hz);
    return static_cast<std::size_t>(
        std::clamp(samples, 0.0, static_cast<double>(motion.samples.size() - 1)));
  };
  return {index(end_s - 1.0 / clock.rate_hz), index(end_s)};
}

Vectors mean_force_n(const SceneOptions&, const ClipMotion& motion, Period period) {
  Eigen::Vector3d sum_n = Eigen::Vector3d::Zero();
  for (std::size_t i = period.first + 1; i <= period.last; ++i)
    sum_n += motion.samples[i].contact_force_n;
  return {sum_n / std::max<std::size_t>(1, period.last - period.first)};
}

Vectors mean_acceleration_m_per_s2(const SceneOptions& options, const ClipMotion& motion,
                                   Period period) {
  const SceneSample &first = motion.samples[period.first], &last = motion.samples[period.last];
  const double seconds = std::max(period.seconds(), control_interval_s);
  return {(tracked_state(options.object, last).velocity_m_per_s -
           tracked_state(options.object, first).velocity_m_per_s) /
              seconds,
          (last.hand.velocity_m_per_s - first.hand.velocity_m_per_s) / seconds};
}

struct Quantity {
  const char* name;
  Vectors (*mean)(const SceneOptions&, const ClipMotion&, Period);
};
constexpr Quantity quantities[] = {{"force", mean_force_n},
                                   {"acceleration", mean_acceleration_m_per_s2}};

std::uint16_t count_of(double value) {
  const double share = std::clamp(value / full_scale, 0.0, 1.0);
  return static_cast<std::uint16_t>(std::lround(share * ((1 << oracle_bits) - 1)));
}

void draw_vectors(const Vectors& vectors, std::span<std::uint16_t> image) {
  const int signs = 2 * static_cast<int>(vectors.size());
  for (int row = 0; row < glove_rows; ++row)
    for (int col = 0; col < glove_cols; ++col) {
      const int sign = row * signs / glove_rows, axis = col * 3 / glove_cols;
      const double value = vectors[sign / 2][axis];
      image[row * glove_cols + col] = count_of(sign % 2 == 0 ? value : -value);
    }
}

void describe_oracle(const std::string& sensed, GloveInfo& info) {
  info.name = "exact " + sensed;
  info.bits = oracle_bits;
  std::ranges::fill(info.baseline_counts, 0.0f);
  std::ranges::fill(info.mask, 1);
}

}  // namespace

std::vector<std::string> sensed_names() {
  std::vector<std::string> names{"touch"};
  for (const Quantity& quantity : quantities) names.push_back(quantity.name);
  return names;
}

void replace_touch(const SceneOptions& options, ClipMotion& motion) {
  const auto quantity = std::ranges::find(quantities, options.sensed, &Quantity::name);
  if (quantity == std::end(quantities)) return;
  const GloveClock clock = glove_clock(options);
  describe_oracle(options.sensed, motion.glove.info);
  const std::size_t taxels = motion.glove.info.taxels();
  for (std::size_t frame = 0; frame < motion.glove.frames(); ++frame)
    draw_vectors(quantity->mean(options, motion, frame_period(motion, clock, frame)),
                 std::span(motion.glove.counts).subspan(frame * taxels, taxels));
}

}  // namespace touchtrace::scene
