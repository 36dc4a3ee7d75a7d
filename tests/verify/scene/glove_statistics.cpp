#include "tests/verify/scene/glove_statistics.h"

#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/statistics.h"

namespace touchtrace::scene {
namespace {

constexpr std::size_t min_frames = 20;
constexpr double rest_fraction = 0.1, loaded = 0.1, peak_quantile = 0.99;
constexpr double quiet_sigmas = 6.0;  // of the noise: 99th percentile of a taxel without load
constexpr double half_a_second = 0.5, max_gap_s = 1.0;

/// Pressures [frames, taxels of the mask], fraction of the full scale.
struct Pressures {
  explicit Pressures(const GloveStream& glove);

  const GloveStream& glove;
  std::vector<int> cells;  ///< cell of each taxel
  Eigen::MatrixXd values;
  Eigen::VectorXd total;  ///< mean of each frame
};

Pressures::Pressures(const GloveStream& stream) : glove(stream) {
  const GloveInfo& info = glove.info;
  for (int cell = 0; cell < info.taxels(); ++cell)
    if (info.mask[cell]) cells.push_back(cell);
  const double full_scale = (1 << info.bits) - 1;
  values.resize(static_cast<Eigen::Index>(glove.frames()), static_cast<Eigen::Index>(cells.size()));
  for (Eigen::Index f = 0; f < values.rows(); ++f)
    for (Eigen::Index t = 0; t < values.cols(); ++t) {
      const int cell = cells[t];
      const double count = glove.counts[std::size_t(f) * info.taxels() + cell];
      values(f, t) = info.polarity * (count - info.baseline_counts[cell]) / full_scale;
    }
  total = values.rowwise().mean();
}

std::vector<double> to_vector(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return {values.begin(), values.end()};
}

double correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd x = a.array() - a.mean(), y = b.array() - b.mean();
  return x.dot(y) / std::sqrt(x.squaredNorm() * y.squaredNorm());
}

double mean_finite(const std::vector<double>& values) {
  double sum = 0.0, count = 0.0;
  for (const double value : values)
    if (std::isfinite(value)) sum += value, ++count;
  return sum / count;
}

/// Indices of frames at rest, in order.
std::vector<Eigen::Index> rest_frames(const Pressures& p) {
  const double limit = quantile(to_vector(p.total), rest_fraction);
  std::vector<Eigen::Index> frames;
  for (Eigen::Index f = 0; f < p.total.size(); ++f)
    if (p.total[f] <= limit) frames.push_back(f);
  return frames;
}

void measure_rest(const Pressures& p, GloveStatistics& s) {
  const GloveInfo& info = p.glove.info;
  const auto frames = rest_frames(p);
  const double full_scale = (1 << info.bits) - 1;
  std::vector<double> levels, noises, deviations;
  for (Eigen::Index t = 0; t < p.values.cols(); ++t) {
    std::vector<double> level, changes;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      level.push_back(p.values(frames[i], t));
      if (i > 0 && frames[i] == frames[i - 1] + 1)
        changes.push_back(std::pow(p.values(frames[i], t) - p.values(frames[i - 1], t), 2));
    }
    const double rest = info.baseline_counts[p.cells[t]] / full_scale;
    levels.push_back(rest + info.polarity * median(level));
    if (!changes.empty())
      noises.push_back(std::sqrt(0.5 * std::accumulate(changes.begin(), changes.end(), 0.0) /
                                 static_cast<double>(changes.size())));
  }
  s.rest_level = median(levels);
  for (const double level : levels) deviations.push_back(level - s.rest_level);
  s.rest_spread = robust_sigma(deviations);
  s.noise = median(noises);
}

void measure_levels(const Pressures& p, GloveStatistics& s) {
  const GloveInfo& info = p.glove.info;
  const int saturated = info.polarity > 0 ? (1 << info.bits) - 1 : 0;
  const double readings = static_cast<double>(p.values.size());
  s.peak_pressure = quantile({p.values.data(), p.values.data() + p.values.size()}, peak_quantile);
  s.loaded_taxels = static_cast<double>((p.values.array() > loaded).count()) / readings;
  for (std::size_t f = 0; f < p.glove.frames(); ++f)
    for (const int cell : p.cells)
      s.saturated_readings += (p.glove.counts[f * info.taxels() + cell] == saturated) / readings;
  for (Eigen::Index t = 0; t < p.values.cols(); ++t)
    s.constant_taxels += (p.values.col(t).maxCoeff() == p.values.col(t).minCoeff()) /
                         static_cast<double>(p.values.cols());
}

void measure_motion(const Pressures& p, GloveStatistics& s) {
  const auto& sequence = p.glove.sequence;
  const double max_gap = max_gap_s * p.glove.info.rate_hz;
  std::vector<double> changes;
  double lost = 0.0;
  for (Eigen::Index f = 1; f < p.values.rows(); ++f) {
    const auto missing = static_cast<double>(sequence[f] - sequence[f - 1] - 1);
    if (missing <= max_gap) lost += missing;
    if (missing == 0.0)
      for (Eigen::Index t = 0; t < p.values.cols(); ++t)
        changes.push_back(std::abs(p.values(f, t) - p.values(f - 1, t)));
  }
  s.change = quantile(changes, peak_quantile);
  s.lost_frames = lost / (lost + static_cast<double>(sequence.size()));
  const auto lag = static_cast<Eigen::Index>(std::lround(half_a_second * p.glove.info.rate_hz));
  const Eigen::Index pairs = p.total.size() - lag;
  s.correlation_half_second = pairs > 2 ? correlation(p.total.head(pairs), p.total.tail(pairs))
                                        : std::numeric_limits<double>::quiet_NaN();
}

void measure_quiet_taxels(const Pressures& p, GloveStatistics& s) {
  Eigen::VectorXd quiet = Eigen::VectorXd::Zero(p.total.size()), others = quiet;
  for (Eigen::Index t = 0; t < p.values.cols(); ++t) {
    const double peak = quantile(to_vector(p.values.col(t)), peak_quantile);
    (peak < quiet_sigmas * s.noise ? quiet : others) += p.values.col(t);
  }
  s.quiet_correlation = correlation(quiet, others);
}

void measure_neighbours(const Pressures& p, GloveStatistics& s) {
  std::vector<Eigen::Index> taxel_at(p.glove.info.taxels(), -1);
  for (std::size_t t = 0; t < p.cells.size(); ++t) taxel_at[p.cells[t]] = Eigen::Index(t);
  const int cols = p.glove.info.cols;
  std::vector<double> in_row, in_column;
  for (std::size_t t = 0; t < p.cells.size(); ++t) {
    const int cell = p.cells[t];
    const auto add = [&](std::vector<double>& to, int neighbour) {
      if (neighbour < p.glove.info.taxels() && taxel_at[neighbour] >= 0)
        to.push_back(correlation(p.values.col(Eigen::Index(t)), p.values.col(taxel_at[neighbour])));
    };
    if ((cell + 1) % cols != 0) add(in_row, cell + 1);
    add(in_column, cell + cols);
  }
  s.row_correlation = mean_finite(in_row), s.column_correlation = mean_finite(in_column);
}

}  // namespace

GloveStatistics glove_statistics(const GloveStream& glove) {
  if (glove.frames() < min_frames)
    throw data_error(
        fmt::format("the glove has {} frames, at least {} are needed", glove.frames(), min_frames),
        "give a longer recording");
  const Pressures pressures(glove);
  GloveStatistics statistics;
  measure_rest(pressures, statistics);
  measure_levels(pressures, statistics);
  measure_motion(pressures, statistics);
  measure_quiet_taxels(pressures, statistics);
  measure_neighbours(pressures, statistics);
  return statistics;
}

}  // namespace touchtrace::scene
