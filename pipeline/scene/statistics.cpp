#include "pipeline/scene/statistics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace touchtrace::scene {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::Vector3d;

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  const auto nth =
      values.begin() + static_cast<long>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// Forces are of the end of each interval, so they are held against the velocity gained in it.
double force_residual(const std::vector<ClipMotion>& clips, const ObjectSpec& object) {
  double error = 0.0, scale = 0.0;
  for (const ClipMotion& clip : clips)
    for (std::size_t i = 1; i < clip.samples.size(); ++i) {
      const SceneSample &now = clip.samples[i], &before = clip.samples[i - 1];
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

/// Frames and the hand's positions at their scans, of the clips for which `chosen` holds.
struct Probe {
  MatrixXd frames, positions;
};

Probe collect(const std::vector<ClipMotion>& clips, const GloveClock& clock, bool held_out) {
  Index rows = 0;
  const auto chosen = [&](std::size_t i) { return (i % 4 == 3) == held_out; };
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (chosen(i)) rows += static_cast<Index>(clips[i].glove.frames());
  Probe probe{MatrixXd(rows, clips.front().glove.info.taxels()), MatrixXd(rows, 3)};
  Index row = 0;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!chosen(i)) continue;
    const GloveStream& glove = clips[i].glove;
    const auto cells = static_cast<std::size_t>(glove.info.taxels());
    for (std::size_t frame = 0; frame < glove.frames(); ++frame, ++row) {
      for (std::size_t cell = 0; cell < cells; ++cell)
        probe.frames(row, static_cast<Index>(cell)) =
            glove.counts[frame * cells + cell] - glove.info.baseline_counts[cell];
      const double time_s = clock.first_frame_s +
                            static_cast<double>(glove.sequence[frame]) / clock.rate_hz +
                            0.5 * glove.info.scan_s;
      const auto& samples = clips[i].samples;
      const double at = std::round((time_s - samples.front().time_s) * sample_rate_hz);
      const auto index =
          static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(samples.size() - 1)));
      probe.positions.row(row) = samples[index].hand.position_m.transpose();
    }
  }
  return probe;
}

}  // namespace

ClipStatistics statistics(const std::vector<ClipMotion>& clips, const ObjectSpec& object) {
  ClipStatistics s;
  std::vector<double> grip_n;
  double saturated = 0.0, readings = 0.0;
  for (const ClipMotion& clip : clips) {
    s.drop_share += (clip.dropped ? 1.0 : 0.0) / static_cast<double>(clips.size());
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

Vector3d position_probe_r2(const std::vector<ClipMotion>& clips, const GloveClock& clock) {
  const Probe fit = collect(clips, clock, false), test = collect(clips, clock, true);
  const Eigen::RowVectorXd mean = fit.frames.colwise().mean();
  const Eigen::RowVector3d place = fit.positions.colwise().mean();
  const MatrixXd centred = fit.frames.rowwise() - mean;
  const MatrixXd wanted = centred.transpose() * (fit.positions.rowwise() - place);
  const Eigen::RowVector3d middle = test.positions.colwise().mean();
  const Eigen::Array3d spread =
      (test.positions.rowwise() - middle).colwise().squaredNorm().transpose().array();
  Eigen::Array3d best = Eigen::Array3d::Constant(-1e9);
  for (double deviation_counts : {1.5, 15.0, 150.0}) {
    MatrixXd normal = MatrixXd::Zero(centred.cols(), centred.cols());
    normal.selfadjointView<Eigen::Lower>().rankUpdate(centred.transpose());
    normal.diagonal().array() +=
        deviation_counts * deviation_counts * static_cast<double>(centred.rows());
    const MatrixXd weights = normal.selfadjointView<Eigen::Lower>().llt().solve(wanted);
    const MatrixXd guess = ((test.frames.rowwise() - mean) * weights).rowwise() + place;
    const Eigen::Array3d error =
        (guess - test.positions).colwise().squaredNorm().transpose().array();
    best = best.max(1.0 - error / spread);
  }
  return best;
}

}  // namespace touchtrace::scene
