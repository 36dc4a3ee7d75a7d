#include "tests/verify/scene/probe.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace touchtrace::scene {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::RowVectorXd, Eigen::Vector3d;

constexpr int folds = 4;
constexpr double large_counts = 1e3;  // scale of inputs other than readings, beyond any ridge
constexpr double phase_step_s = 0.05;
constexpr int phase_steps = 10;  // on either side of a release or catch

/// Frames of every fourth clip: inputs and given inputs, each with a constant column at the end,
/// and hand positions.
struct Fold {
  MatrixXd inputs, given, positions;
};

/// Sample in the middle of a frame's scan.
const SceneSample& sample_of_frame(const ClipMotion& clip, const GloveClock& clock,
                                   std::size_t frame) {
  const double scan_start_s =
      clock.first_frame_s + static_cast<double>(clip.glove.sequence[frame]) / clock.rate_hz;
  const double at = std::round(
      (scan_start_s + 0.5 * clip.glove.info.scan_s - clip.samples.front().time_s) * sample_rate_hz);
  const double last = static_cast<double>(clip.samples.size() - 1);
  return clip.samples[static_cast<std::size_t>(std::clamp(at, 0.0, last))];
}

RowVectorXd readings(const GloveStream& glove, std::size_t frame) {
  RowVectorXd less_baseline(glove.info.taxels());
  for (Index cell = 0; cell < less_baseline.size(); ++cell) {
    const auto c = static_cast<std::size_t>(cell);
    less_baseline[cell] =
        glove.counts[frame * glove.info.mask.size() + c] - glove.info.baseline_counts[c];
  }
  return less_baseline;
}

RowVectorXd phase(const ClipMotion& clip, double time_s) {
  RowVectorXd flags = RowVectorXd::Zero(4 * phase_steps + 1);
  Index flag = 4 * phase_steps;
  double nearest_s = phase_steps * phase_step_s;
  for (const Truth::Event& event : clip.events) {
    const bool is_catch = event.kind == "catch";
    const double after_s = time_s - event.time_s;
    if ((!is_catch && event.kind != "release") || std::abs(after_s) >= nearest_s) continue;
    nearest_s = std::abs(after_s);
    flag = (is_catch ? 3 : 1) * phase_steps + std::lround(std::floor(after_s / phase_step_s));
  }
  flags[flag] = large_counts;
  return flags;
}

/// Horizontal components of the object's upright axis and of its rate.
RowVectorXd lean(const RigidState& object) {
  const Vector3d upright = object.orientation * Vector3d::UnitZ(),
                 rate_per_s = object.angular_velocity_rad_per_s.cross(upright);
  RowVectorXd both(4);
  both << upright.head<2>().transpose(), rate_per_s.head<2>().transpose();
  return 1e2 * large_counts * both;
}

RowVectorXd lean_and_force(const SceneSample& sample) {
  RowVectorXd all(7);
  all << lean(sample.object), large_counts * sample.contact_force_n.transpose();
  return all;
}

RowVectorXd probe_input(const ClipMotion& clip, std::size_t frame, const SceneSample& sample,
                        ProbeInput input) {
  switch (input) {
    case ProbeInput::readings:
      return readings(clip.glove, frame);
    case ProbeInput::phase:
      return phase(clip, sample.time_s);
    case ProbeInput::lean:
      return lean(sample.object);
    case ProbeInput::lean_and_force:
      return lean_and_force(sample);
    case ProbeInput::contact:
      break;
  }
  return RowVectorXd::Constant(1, sample.contact_force_n.isZero(0.0) ? 0.0 : large_counts);
}

void append(MatrixXd& table, Index row, const RowVectorXd& values) {
  if (row == 0) table.setOnes(table.rows(), values.size() + 1);
  table.row(row).head(values.size()) = values;
}

Fold collect(const std::vector<ClipMotion>& clips, const GloveClock& clock, std::size_t first,
             ProbeInput input, const std::optional<ProbeInput>& given) {
  Index rows = 0, row = 0;
  for (std::size_t i = first; i < clips.size(); i += folds)
    rows += static_cast<Index>(clips[i].glove.frames());
  Fold fold{MatrixXd(rows, 0), MatrixXd(rows, 0), MatrixXd(rows, 3)};
  for (std::size_t i = first; i < clips.size(); i += folds)
    for (std::size_t frame = 0; frame < clips[i].glove.frames(); ++frame, ++row) {
      const SceneSample& sample = sample_of_frame(clips[i], clock, frame);
      append(fold.inputs, row, probe_input(clips[i], frame, sample, input));
      if (given) append(fold.given, row, probe_input(clips[i], frame, sample, *given));
      fold.positions.row(row) = sample.hand.position_m.transpose();
    }
  return fold;
}

/// Solves the normal equations with a ridge on all but the last unknown.
MatrixXd ridge_fit(MatrixXd normal, const MatrixXd& right_side, double ridge) {
  normal.diagonal().head(normal.rows() - 1).array() += ridge;
  return normal.selfadjointView<Eigen::Lower>().llt().solve(right_side);
}

/// Replaces positions and inputs by their residuals of a linear fit to the given inputs (theorem of
/// Frisch, Waugh and Lovell). Constant columns stay.
void remove_given(std::array<Fold, folds>& parts) {
  const Index columns = parts[0].given.cols(), inputs = parts[0].inputs.cols() - 1;
  if (columns == 0) return;
  MatrixXd normal = MatrixXd::Zero(columns, columns), wanted = MatrixXd::Zero(columns, 3 + inputs);
  for (const Fold& part : parts) {
    normal += part.given.transpose() * part.given;
    wanted.leftCols(3) += part.given.transpose() * part.positions;
    wanted.rightCols(inputs) += part.given.transpose() * part.inputs.leftCols(inputs);
  }
  const MatrixXd weights = ridge_fit(normal, wanted, 1.0);
  for (Fold& part : parts) {
    part.positions -= part.given * weights.leftCols(3);
    part.inputs.leftCols(inputs) -= part.given * weights.rightCols(inputs);
  }
}

Eigen::RowVector3d mean_position(const std::array<Fold, folds>& parts, double frames) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (const Fold& part : parts) sum += part.positions.colwise().sum();
  return sum / frames;
}

}  // namespace

Vector3d position_probe_r2(const std::vector<ClipMotion>& clips, const GloveClock& clock,
                           ProbeInput input, std::optional<ProbeInput> given) {
  constexpr std::array<double, 3> ridge_counts{1.5, 15.0, 150.0};  // per frame
  std::array<Fold, folds> parts;
  double frames = 0.0;
  for (int i = 0; i < folds; ++i) {
    parts[i] = collect(clips, clock, static_cast<std::size_t>(i), input, given);
    frames += static_cast<double>(parts[i].inputs.rows());
  }
  remove_given(parts);
  std::array<MatrixXd, folds> normal, wanted;
  for (int i = 0; i < folds; ++i) {
    normal[i] = parts[i].inputs.transpose() * parts[i].inputs;
    wanted[i] = parts[i].inputs.transpose() * parts[i].positions;
  }
  const Eigen::RowVector3d mean = mean_position(parts, frames);
  Eigen::Array<double, 3, ridge_counts.size()> error = decltype(error)::Zero();
  Eigen::Array3d spread = Eigen::Array3d::Zero();
  for (int held_out = 0; held_out < folds; ++held_out) {
    MatrixXd rest = MatrixXd::Zero(normal[0].rows(), normal[0].cols()), goal = 0.0 * wanted[0];
    for (int i = 0; i < folds; ++i)
      if (i != held_out) rest += normal[i], goal += wanted[i];
    const Fold& part = parts[held_out];
    for (std::size_t r = 0; r < ridge_counts.size(); ++r) {
      const MatrixXd weights = ridge_fit(rest, goal, frames * ridge_counts[r] * ridge_counts[r]);
      error.col(static_cast<Index>(r)) +=
          (part.inputs * weights - part.positions).colwise().squaredNorm().transpose().array();
    }
    spread += (part.positions.rowwise() - mean).colwise().squaredNorm().transpose().array();
  }
  return 1.0 - error.rowwise().minCoeff() / spread;
}

}  // namespace touchtrace::scene
