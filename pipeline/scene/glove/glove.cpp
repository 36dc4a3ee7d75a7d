#include "pipeline/scene/glove/glove.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>

#include "pipeline/scene/base/motion.h"
#include "pipeline/scene/objects/sin_cos.h"

namespace touchtrace::scene {
namespace {

constexpr int glove_cells = glove_rows * glove_cols;
constexpr double max_count = 1023.0, negligible_n = 1e-4, negligible_creep = 1e-3;
/// Time constants of the creep: equal factors a decade apart make the reading grow with a power of
/// time from 0.05 to 20 s.
const Eigen::Array3d creep_times_s{0.1, 1.0, 10.0};

GloveTraits make_traits(int number, const GloveParameters& p) {
  const std::size_t taxels = hand_model().taxels.size();
  RandomStream random(static_cast<std::uint64_t>(number), "glove traits");
  GloveTraits traits;
  for (std::size_t i = 0; i < taxels; ++i) {
    const bool dead = random.uniform() < p.dead_fraction;
    const double gain = std::exp(random.normal(0.0, p.log_gain_std));
    traits.gain.push_back(dead ? 0.0f : static_cast<float>(gain));
    traits.drift_rad_per_s.push_back(
        static_cast<float>(2 * std::numbers::pi / draw(random, p.drift_period_s)));
    traits.drift_phase_rad.push_back(static_cast<float>(random.uniform(0.0, 2 * std::numbers::pi)));
  }
  for (int i = 0; i < glove_cells; ++i)
    traits.baseline_counts.push_back(
        static_cast<float>(std::max(8.0, random.normal(p.baseline_counts, p.baseline_std_counts))));
  return traits;
}

/// Random streams of different instances are independent.
std::string stream_name(int number, const char* what) {
  return number == 1 ? fmt::format("glove {}", what) : fmt::format("glove {} {}", number, what);
}

/// Position of a taxel on the open hand, hand's frame.
Eigen::Vector3d open_position(const Taxel& taxel) {
  if (taxel.finger < 0) return taxel.position_m;
  const FingerPose pose = pose_finger(hand_model().fingers[taxel.finger], 0.0);
  return pose.joint_m[taxel.link] + pose.hand_from_link[taxel.link] * taxel.position_m;
}

/// Four standard normal numbers of a stream's block by the Box-Muller transform; at most 6.7, from
/// 32-bit uniforms.
std::array<double, 4> four_normals(const RandomStream& stream, std::uint64_t block) {
  const auto words = stream.block(block);
  const auto squared_radius = [&](int i) { return -2.0 * std::log((words[i] + 0.5) * 0x1p-32); };
  const Lanes radius = sqrt(Lanes{squared_radius(0), squared_radius(2)});
  const SinCos angle = sin_cos(2.0 * std::numbers::pi * 0x1p-32 *
                               Lanes{static_cast<double>(words[1]), static_cast<double>(words[3])});
  const Lanes x = radius * angle.cosine, y = radius * angle.sine;
  return {x[0], y[0], x[1], y[1]};
}

}  // namespace

const GloveTraits& glove_traits(int number, const GloveParameters& parameters) {
  static std::mutex guard;
  static std::map<std::pair<int, GloveParameters>, GloveTraits> known;
  const std::lock_guard lock(guard);
  const auto [entry, is_new] = known.try_emplace({number, parameters});
  if (is_new) entry->second = make_traits(number, parameters);
  return entry->second;
}

GloveInfo glove_info(int number, const GloveParameters& parameters) {
  GloveInfo info;
  info.name = fmt::format("simulated glove {}", number);
  info.rows = glove_rows;
  info.cols = glove_cols;
  info.scan_s = parameters.scan_s;
  info.baseline_counts = glove_traits(number, parameters).baseline_counts;
  info.mask.assign(glove_cells, 0);
  info.taxel_position_m.assign(3 * glove_cells, std::numeric_limits<float>::quiet_NaN());
  for (const Taxel& taxel : hand_model().taxels) {
    info.mask[taxel.cell()] = 1;
    const Eigen::Vector3d p = open_position(taxel);
    for (int axis = 0; axis < 3; ++axis)
      info.taxel_position_m[3 * taxel.cell() + axis] = static_cast<float>(p[axis]);
  }
  return info;
}

Glove::Glove(int number, const GloveParameters& parameters, const GloveClock& clock,
             std::uint64_t seed)
    : parameters_(parameters),
      traits_(glove_traits(number, parameters)),
      clock_(clock),
      noise_(seed, stream_name(number, "noise")),
      transport_(seed, stream_name(number, "transport")),
      lagged_n_(traits_.gain.size(), 0.0),
      crept_(traits_.gain.size(), Eigen::Array3d::Zero()),
      gain_(traits_.gain.size(), 0.0),
      is_active_(traits_.gain.size(), 0),
      signal_(glove_cells, 0.0),
      row_sum_(glove_rows, 0.0),
      col_sum_(glove_cols, 0.0),
      frame_(glove_cells, 0) {
  stream_.info = glove_info(number, parameters);
  active_.reserve(traits_.gain.size());
}

double Glove::row_time_s(std::uint64_t frame, int row) const {
  return clock_.first_frame_s + static_cast<double>(frame) / clock_.rate_hz +
         parameters_.scan_s * row / glove_rows;
}

void Glove::start(double time_s) {
  number_ = static_cast<std::uint64_t>(
      std::max(0.0, std::ceil((time_s - clock_.first_frame_s) * clock_.rate_hz)));
  next_row_ = 0;
  stream_.sequence.clear();
  stream_.host_time_s.clear();
  stream_.counts.clear();
}

void Glove::update_sensor(const TaxelForces& forces, double interval_s) {
  for (int i : forces.loaded)
    if (forces.force_n[i] > 0.0 && !is_active_[i]) {
      is_active_[i] = 1, active_.push_back(i);
      gain_[i] = gain_at(i, frame_time_s_);
    }
  const double lagging = -std::expm1(-interval_s / parameters_.lag_s);
  const Eigen::Array3d creeping = 1.0 - (-interval_s / creep_times_s).exp();
  std::erase_if(active_, [&](int i) {
    lagged_n_[i] += lagging * (forces.force_n[i] - lagged_n_[i]);
    const bool is_loaded = lagged_n_[i] > negligible_n;
    crept_[i] += creeping * (double(is_loaded) - crept_[i]);
    const bool is_at_rest = !is_loaded && crept_[i].sum() < negligible_creep;
    if (is_at_rest) deactivate(i);
    return is_at_rest;
  });
}

void Glove::deactivate(int taxel) {
  is_active_[taxel] = 0;
  lagged_n_[taxel] = signal_[hand_model().taxels[taxel].cell()] = 0.0;
  crept_[taxel].setZero();
}

double Glove::gain_at(int taxel, double time_s) const {
  const double phase_rad = traits_.drift_rad_per_s[taxel] * time_s + traits_.drift_phase_rad[taxel];
  return traits_.gain[taxel] * (1 + parameters_.drift * std::sin(phase_rad));
}

/// Once per frame: gains change by less than 3e-5 of themselves while a frame is read.
void Glove::update_gains(double time_s) {
  frame_time_s_ = time_s;
  for (int i : active_) gain_[i] = gain_at(i, time_s);
}

void Glove::compute_signals() {
  std::ranges::fill(row_sum_, 0.0);
  std::ranges::fill(col_sum_, 0.0);
  const std::vector<Taxel>& taxels = hand_model().taxels;
  for (int i : active_) {
    const Taxel& taxel = taxels[i];
    const double crept = std::pow(1.0 + parameters_.creep, crept_[i].sum());
    const double force = gain_[i] * lagged_n_[i] * crept;
    const double signal = force / (force + parameters_.half_saturation_n);
    signal_[taxel.cell()] = signal;
    row_sum_[taxel.row] += signal;
    col_sum_[taxel.col] += signal;
  }
}

void Glove::read_row(int row) {
  std::array<double, 4> noise{};
  for (int col = 0; col < glove_cols; ++col) {
    const int cell = row * glove_cols + col;
    if (cell % 4 == 0) noise = four_normals(noise_, (number_ * glove_cells + cell) / 4);
    const double own = signal_[cell];
    const double leaked = parameters_.cross_talk * (row_sum_[row] + col_sum_[col] - 2 * own);
    const double read = stream_.info.mask[cell]
                            ? (own + leaked) / (1 + parameters_.cross_talk * row_sum_[row])
                            : 0.0;
    const double counts = traits_.baseline_counts[cell] + parameters_.full_scale_counts * read +
                          parameters_.noise_counts * noise[cell % 4];
    frame_[cell] = static_cast<std::uint16_t>(std::clamp(counts, 0.0, max_count) + 0.5);
  }
}

void Glove::finish_frame() {
  next_row_ = 0;
  const std::uint64_t draw = 2 * number_;
  const std::uint64_t sequence = number_++;
  if (transport_.uniform_at(draw) < clock_.lost_share) return;
  const double jitter_s = -clock_.jitter_s * std::log1p(-transport_.uniform_at(draw + 1));
  const double arrival_s = row_time_s(sequence, glove_rows) + clock_.latency_s + jitter_s;
  const double last_s = stream_.host_time_s.empty() ? -1e300 : stream_.host_time_s.back();
  stream_.sequence.push_back(sequence);
  stream_.host_time_s.push_back(std::max(arrival_s, last_s + 1e-5));
  stream_.counts.insert(stream_.counts.end(), frame_.begin(), frame_.end());
}

void Glove::sense(const TaxelForces& forces, double time_s, double interval_s) {
  update_sensor(forces, interval_s);
  for (bool is_measured = false; row_time_s(number_, next_row_) <= time_s; is_measured = true) {
    if (next_row_ == 0) update_gains(time_s);
    if (next_row_ == 0 || !is_measured) compute_signals();
    read_row(next_row_);
    if (++next_row_ == glove_rows) finish_frame();
  }
}

GloveStream Glove::take() { return std::move(stream_); }

GloveClock glove_clock(const SceneOptions& options) {
  const GloveParameters& p = options.parameters.glove;
  RandomStream random(options.seed, stream_name(options.glove, "clock"));
  GloveClock clock;
  clock.rate_hz = 15.0 * (1 + 1e-6 * random.normal(0.0, p.clock_ppm));
  clock.first_frame_s = -random.uniform(60.0, 120.0);
  clock.latency_s = p.latency_s, clock.jitter_s = p.jitter_s, clock.lost_share = p.lost_fraction;
  return clock;
}

}  // namespace touchtrace::scene
