#include "pipeline/scene/laboratory/statistics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace touchtrace::scene {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::Vector3d;

bool is_struck(const ClipMotion& clip, double from_s, double to_s) {
  return std::ranges::any_of(clip.events, [&](const Truth::Event& event) {
    return event.kind == "impact" && event.time_s > from_s && event.time_s <= to_s;
  });
}

/// Forces are of the end of each interval, so they are held against the velocity gained in it.
/// Intervals in which a ball strikes the object, too, are left out.
double force_residual(const std::vector<ClipMotion>& clips, const ObjectSpec& object) {
  double error = 0.0, scale = 0.0;
  for (const ClipMotion& clip : clips)
    for (std::size_t i = 1; i < clip.samples.size(); ++i) {
      const SceneSample &now = clip.samples[i], &before = clip.samples[i - 1];
      if (is_struck(clip, before.time_s, now.time_s)) continue;
      const Vector3d acceleration =
          (now.object.velocity_m_per_s - before.object.velocity_m_per_s) * sample_rate_hz;
      const Vector3d load = object.mass_kg * (acceleration + gravity_m_per_s2 * Vector3d::UnitZ());
      error += (now.contact_force_n - load).squaredNorm();
      scale += load.squaredNorm();
    }
  return std::sqrt(error / scale);
}

void add_apexes(const ClipMotion& clip, std::vector<double>& apex_m) {
  double release_s = -1.0;
  for (const Truth::Event& event : clip.events) {
    if (event.kind == "release") release_s = event.time_s;
    if (event.kind != "catch") continue;
    double lowest = 1e9, highest = -1e9;
    for (const SceneSample& sample : clip.samples) {
      if (sample.time_s < release_s || sample.time_s > event.time_s) continue;
      if (lowest == 1e9) lowest = sample.object.position_m.z();
      highest = std::max(highest, sample.object.position_m.z());
    }
    apex_m.push_back(highest - lowest);
  }
}

constexpr int folds = 4;
constexpr double flag_counts = 1e3;  // so large that no ridge matters to it

/// What is probed of every fourth clip's frames, with a one at the end, and the hand's positions at
/// their scans.
struct Fold {
  MatrixXd frames, positions;
};

/// In the middle of a frame's scan.
const SceneSample& sample_at(const ClipMotion& clip, const GloveClock& clock, std::size_t frame) {
  const double scan_start_s =
      clock.first_frame_s + static_cast<double>(clip.glove.sequence[frame]) / clock.rate_hz;
  const double at = std::round(
      (scan_start_s + 0.5 * clip.glove.info.scan_s - clip.samples.front().time_s) * sample_rate_hz);
  const double last = static_cast<double>(clip.samples.size() - 1);
  return clip.samples[static_cast<std::size_t>(std::clamp(at, 0.0, last))];
}

bool touches(const SceneSample& sample) { return !sample.contact_force_n.isZero(0.0); }

/// Readings less the baseline, or whether anything is touched.
Eigen::RowVectorXd probed_of(const ClipMotion& clip, std::size_t frame, bool touched,
                             const Probe& probe) {
  if (probe.sees == Probe::Sees::whether_touched)
    return Eigen::RowVectorXd::Constant(1, touched ? flag_counts : 0.0);
  const GloveStream& glove = clip.glove;
  Eigen::RowVectorXd readings(glove.info.taxels());
  for (Index cell = 0; cell < readings.size(); ++cell) {
    const auto c = static_cast<std::size_t>(cell);
    readings[cell] =
        glove.counts[frame * glove.info.mask.size() + c] - glove.info.baseline_counts[c];
  }
  return readings;
}

Fold collect(const std::vector<ClipMotion>& clips, const GloveClock& clock, std::size_t first,
             const Probe& probe) {
  Index rows = 0;
  for (std::size_t i = first; i < clips.size(); i += folds)
    rows += static_cast<Index>(clips[i].glove.frames());
  const Index columns = probe.sees == Probe::Sees::readings ? clips.front().glove.info.taxels() : 1;
  Fold fold{MatrixXd::Ones(rows, columns + 1), MatrixXd(rows, 3)};
  Index row = 0;
  for (std::size_t i = first; i < clips.size(); i += folds)
    for (std::size_t frame = 0; frame < clips[i].glove.frames(); ++frame) {
      const SceneSample& sample = sample_at(clips[i], clock, frame);
      const bool touched = touches(sample);
      if (probe.only_touched && !touched) continue;
      fold.frames.row(row).head(columns) = probed_of(clips[i], frame, touched, probe);
      fold.positions.row(row++) = sample.hand.position_m.transpose();
    }
  return {fold.frames.topRows(row), fold.positions.topRows(row)};
}

/// Squared errors at each axis on one fold of a ridge regression on the others; `frames` are
/// theirs.
Eigen::Array3d held_out_error(const MatrixXd& normal, const MatrixXd& wanted, const Fold& fold,
                              double ridge) {
  MatrixXd damped = normal;
  damped.diagonal().head(normal.rows() - 1).array() += ridge;
  const MatrixXd weights = damped.selfadjointView<Eigen::Lower>().llt().solve(wanted);
  return (fold.frames * weights - fold.positions).colwise().squaredNorm().transpose().array();
}

}  // namespace

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  const auto nth =
      values.begin() + static_cast<long>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

ClipStatistics statistics(const std::vector<ClipMotion>& clips, const ObjectSpec& object) {
  ClipStatistics s;
  std::vector<double> grip_n;
  double saturated = 0.0, readings = 0.0;
  for (const ClipMotion& clip : clips) {
    s.drop_share += (clip.dropped ? 1.0 : 0.0) / static_cast<double>(clips.size());
    s.clamped_clip_share += (clip.clamp_hits > 0) / static_cast<double>(clips.size());
    add_apexes(clip, s.apex_m);
    for (const SceneSample& sample : clip.samples) {
      if (sample.grip_force_n > 0.0) grip_n.push_back(sample.grip_force_n);
      s.lowest_object_m =
          std::min(s.lowest_object_m, sample.object.position_m.z() - sample.hand.position_m.z());
    }
    readings += static_cast<double>(clip.glove.counts.size());
    saturated += static_cast<double>(std::ranges::count(clip.glove.counts, 1023));
  }
  s.grip_p01_n = percentile(grip_n, 0.01);
  s.grip_p99_n = percentile(grip_n, 0.99);
  s.saturated_share = saturated / readings;
  s.force_residual = force_residual(clips, object);
  return s;
}

Vector3d position_probe_r2(const std::vector<ClipMotion>& clips, const GloveClock& clock,
                           const Probe& probe) {
  constexpr std::array<double, 3> ridge_counts{1.5, 15.0, 150.0};  // a frame
  std::array<Fold, folds> parts;
  std::array<MatrixXd, folds> normal, wanted;
  Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
  double frames = 0.0;
  for (int i = 0; i < folds; ++i) {
    parts[i] = collect(clips, clock, static_cast<std::size_t>(i), probe);
    normal[i] = parts[i].frames.transpose() * parts[i].frames;
    wanted[i] = parts[i].frames.transpose() * parts[i].positions;
    middle += parts[i].positions.colwise().sum();
    frames += static_cast<double>(parts[i].frames.rows());
  }
  middle /= frames;
  Eigen::Array<double, 3, ridge_counts.size()> error = decltype(error)::Zero();
  Eigen::Array3d spread = Eigen::Array3d::Zero();
  for (int held_out = 0; held_out < folds; ++held_out) {
    MatrixXd rest = MatrixXd::Zero(normal[0].rows(), normal[0].cols()), goal = 0.0 * wanted[0];
    for (int i = 0; i < folds; ++i)
      if (i != held_out) rest += normal[i], goal += wanted[i];
    const Fold& part = parts[held_out];
    for (std::size_t r = 0; r < ridge_counts.size(); ++r)
      error.col(static_cast<Index>(r)) +=
          held_out_error(rest, goal, part, frames * ridge_counts[r] * ridge_counts[r]);
    spread += (part.positions.rowwise() - middle).colwise().squaredNorm().transpose().array();
  }
  return 1.0 - error.rowwise().minCoeff() / spread;
}

}  // namespace touchtrace::scene
