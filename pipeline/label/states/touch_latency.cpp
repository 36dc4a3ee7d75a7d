#include "pipeline/label/states/touch_latency.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "calib/matrix/decomposition.h"
#include "calib/matrix/product.h"
#include "pipeline/dataset/tactile_image.h"

namespace touchtrace::label {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// README.md has the sources of these constants.
constexpr double latency_step_s = 0.005;
constexpr double lag_s = 0.01, lag_sigma_s = 0.0058;  // of the sensor
constexpr double max_sigma_ratio = 0.75;              // of the timeline's
constexpr double segment_s = 20.0, min_segment_s = 4.0;
constexpr std::size_t min_segments = 3, max_segments = 40;
constexpr int parts = 4;          // of the glove along each axis
constexpr double memory_s = 0.6;  // of errors: creep, changes of the grip
constexpr double half_difference_s = 0.05, velocity_step_s = 0.01;
constexpr double margin_s = max_latency_s + half_difference_s;
constexpr double min_variance = 1e-9;  // of standardised touch that acceleration does not explain
constexpr std::size_t num_latencies = std::size_t(max_latency_s / latency_step_s) + 1;

double latency_s(std::size_t i) { return latency_step_s * static_cast<double>(i); }

/// Velocities of a smoothed track, interpolated between samples.
class Velocities {
 public:
  Velocities(const SmoothedTrack& track, double start_s, double end_s) : start_s_(start_s) {
    for (double t = start_s; t < end_s + 2.0 * velocity_step_s; t += velocity_step_s)
      samples_.push_back(track.smoothed(t).velocity_m_per_s);
  }
  Vector3d acceleration(double time_s) const {
    return (at(time_s + half_difference_s) - at(time_s - half_difference_s)) /
           (2.0 * half_difference_s);
  }

 private:
  Vector3d at(double time_s) const {
    const double place = std::max(0.0, (time_s - start_s_) / velocity_step_s);
    const std::size_t i = std::min(static_cast<std::size_t>(place), samples_.size() - 2);
    const double part = place - static_cast<double>(i);
    return (1.0 - part) * samples_[i] + part * samples_[i + 1];
  }

  double start_s_;
  std::vector<Vector3d> samples_;
};

/// Consecutive label times of a clip with frames of the glove.
using Segment = std::vector<LabelTime>;

/// Segments of the clips in which every latency leaves the times within the hand's track.
std::vector<Segment> segments_of(const std::vector<LabelTime>& times,
                                 const std::vector<ClipTrack>& tracks,
                                 const std::vector<SmoothedTrack>& hand_tracks) {
  std::vector<Segment> segments;
  Segment segment;
  const auto finish = [&] {
    if (!segment.empty() && segment.back().time_s - segment.front().time_s > min_segment_s)
      segments.push_back(segment);
    segment.clear();
  };
  for (const LabelTime& time : times) {
    const auto clip = static_cast<std::size_t>(time.clip);
    const auto& seen_s = tracks[clip].time_s;
    if (time.glove_frame < 0 || hand_tracks[clip].status != SmoothStatus::converged ||
        time.time_s < seen_s.front() + margin_s || time.time_s > seen_s.back() - margin_s)
      continue;
    if (!segment.empty() &&
        (time.clip != segment.front().clip || time.time_s > segment.front().time_s + segment_s))
      finish();
    segment.push_back(time);
  }
  finish();
  return segments;
}

/// At most `max_segments`, evenly spread.
std::vector<Segment> some_of(std::vector<Segment> segments) {
  std::vector<Segment> some;
  const std::size_t count = std::min(max_segments, segments.size());
  for (std::size_t i = 0; i < count; ++i)
    some.push_back(std::move(segments[i * segments.size() / count]));
  return some;
}

/// Touch of a segment and the likelihood of latencies.
class SegmentLikelihood {
 public:
  SegmentLikelihood(const GloveStream& glove, const Segment& segment) : segment_(segment) {
    const GloveInfo& info = glove.info;
    const auto taxels = static_cast<std::size_t>(info.taxels());
    const int rows = std::min(parts, info.rows), cols = std::min(parts, info.cols);
    const AreaAverage average(info.rows, info.cols, rows, cols);
    std::vector<float> pressure(taxels), part(static_cast<std::size_t>(rows * cols));
    MatrixXd touch(segment.size(), part.size()), by_row(segment.size(), info.rows);
    for (std::size_t i = 0; i < segment.size(); ++i) {
      const auto frame = static_cast<std::size_t>(segment[i].glove_frame);
      counts_to_pressure(info, std::span(glove.counts).subspan(frame * taxels, taxels), pressure);
      average.apply(pressure, part);
      const auto row = static_cast<Eigen::Index>(i);
      touch.row(row) = Eigen::Map<Eigen::RowVectorXf>(part.data(), touch.cols()).cast<double>();
      by_row.row(row) = Eigen::Map<const Eigen::MatrixXf>(pressure.data(), info.cols, info.rows)
                            .colwise()
                            .sum()
                            .cast<double>();
      is_pair_.push_back(
          i > 0 && glove.sequence[frame] ==
                       glove.sequence[static_cast<std::size_t>(segment[i - 1].glove_frame)] + 1);
    }
    memory_ = std::exp(-1.0 / (info.rate_hz * memory_s));
    read_offset_s_ = read_offset_s(by_row, info.scan_s);
    touch_ = standardized(whitened(touch));
    touch_square_ = product(touch_.transpose(), touch_);
  }

  /// Log-likelihood of each latency. The segment's times were computed with `assumed_latency_s`.
  VectorXd of_latencies(const Velocities& hand, double assumed_latency_s,
                        const Vector3d& gravity_m_per_s2) const {
    VectorXd result(num_latencies);
    for (std::size_t i = 0; i < num_latencies; ++i) {
      const double shift_s = latency_s(i) - assumed_latency_s + read_offset_s_;
      MatrixXd inputs(segment_.size(), 4);
      for (std::size_t k = 0; k < segment_.size(); ++k) {
        const Vector3d acceleration = hand.acceleration(segment_[k].time_s + shift_s);
        inputs.row(static_cast<Eigen::Index>(k)) << acceleration.transpose(),
            (acceleration - gravity_m_per_s2).norm();
      }
      result[static_cast<Eigen::Index>(i)] = log_likelihood(whitened(inputs));
    }
    return result;
  }

 private:
  /// When the rows that change are read, relative to the middle of a scan.
  static double read_offset_s(const MatrixXd& by_row, double scan_s) {
    const MatrixXd centred = by_row.rowwise() - by_row.colwise().mean();
    const VectorXd variance = centred.colwise().squaredNorm();
    if (!(variance.sum() > 0.0)) return 0.0;
    const auto rows = static_cast<double>(variance.size());
    const VectorXd place = VectorXd::LinSpaced(variance.size(), 0.5 / rows, 1.0 - 0.5 / rows);
    return scan_s * (variance.dot(place) / variance.sum() - 0.5);
  }
  /// Each frame minus `memory_` times the one before, without the mean over the frames: errors of
  /// first order become independent. Frames after a lost one are skipped.
  MatrixXd whitened(const MatrixXd& values) const {
    MatrixXd result(std::ranges::count(is_pair_, true), values.cols());
    for (Eigen::Index i = 1, to = 0; i < values.rows(); ++i)
      if (is_pair_[static_cast<std::size_t>(i)])
        result.row(to++) = values.row(i) - memory_ * values.row(i - 1);
    return result.rowwise() - result.colwise().mean();
  }
  /// Columns that change, with unit variance.
  static MatrixXd standardized(const MatrixXd& values) {
    MatrixXd result(values.rows(), values.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < values.cols(); ++i)
      if (const double square = values.col(i).squaredNorm(); square > 0.0)
        result.col(count++) = values.col(i) * std::sqrt(double(values.rows()) / square);
    return result.leftCols(count);
  }
  /// Log-likelihood of a linear model from the inputs to touch, at its best coefficients and
  /// covariance.
  double log_likelihood(const MatrixXd& inputs) const {
    const auto count = static_cast<double>(touch_.rows());
    const MatrixXd across = product(inputs.transpose(), touch_);
    const MatrixXd coefficients = solve_semidefinite(product(inputs.transpose(), inputs), across);
    MatrixXd residual = (touch_square_ - product(across.transpose(), coefficients)) / count;
    residual.diagonal().array() += min_variance;
    return -0.5 * count * Cholesky(residual).log_determinant();
  }

  const Segment& segment_;
  std::vector<bool> is_pair_;  ///< whether the frame follows the one before
  double memory_ = 0.0;        ///< autocorrelation of the errors of consecutive frames
  double read_offset_s_ = 0.0;
  MatrixXd touch_, touch_square_;
};

struct Posterior {
  double mean_s, sigma_s;
};

/// With a uniform prior.
Posterior posterior(const VectorXd& log_likelihood) {
  const VectorXd weight = (log_likelihood.array() - log_likelihood.maxCoeff()).exp();
  const VectorXd latency =
      VectorXd::LinSpaced(log_likelihood.size(), 0.0, latency_s(num_latencies - 1));
  const double mean_s = weight.dot(latency) / weight.sum();
  return {mean_s,
          std::sqrt(weight.dot((latency.array() - mean_s).square().matrix()) / weight.sum())};
}

/// Standard deviation of the mean by leaving each segment out (Efron and Stein 1981).
double jackknife_sigma_s(const std::vector<VectorXd>& segments, const VectorXd& sum) {
  VectorXd without(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i)
    without[static_cast<Eigen::Index>(i)] = posterior(sum - segments[i]).mean_s;
  const auto count = static_cast<double>(segments.size());
  return std::sqrt((count - 1.0) / count * (without.array() - without.mean()).square().sum());
}

}  // namespace

std::optional<LatencyEstimate> latency_from_touch(const GloveStream& glove,
                                                  const Timeline& timeline,
                                                  const std::vector<LabelTime>& times,
                                                  const std::vector<ClipTrack>& tracks,
                                                  const std::vector<SmoothedTrack>& hand_tracks,
                                                  const Vector3d& gravity_m_per_s2) {
  const auto segments = some_of(segments_of(times, tracks, hand_tracks));
  if (segments.size() < min_segments) return std::nullopt;
  std::vector<VectorXd> likelihoods;
  VectorXd sum = VectorXd::Zero(num_latencies);
  for (const Segment& segment : segments) {
    const Velocities hand(hand_tracks[static_cast<std::size_t>(segment.front().clip)],
                          segment.front().time_s - margin_s, segment.back().time_s + margin_s);
    likelihoods.push_back(
        SegmentLikelihood(glove, segment).of_latencies(hand, timeline.latency_s, gravity_m_per_s2));
    sum += likelihoods.back();
  }
  const auto [mean_s, sigma_s] = posterior(sum);
  const double total_s = std::hypot(sigma_s, jackknife_sigma_s(likelihoods, sum), lag_sigma_s);
  if (!(total_s < max_sigma_ratio * timeline.latency_sigma_s)) return std::nullopt;
  return LatencyEstimate{mean_s + lag_s, total_s,
                         fmt::format("touch in {} segments", segments.size())};
}

}  // namespace touchtrace::label
