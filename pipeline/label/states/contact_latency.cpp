#include "pipeline/label/states/contact_latency.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace touchtrace::label {
namespace {

// README.md has the sources of these constants.
constexpr double latency_step_s = 0.001;
constexpr double rise_s = 0.35;           // in which contact becomes firm
constexpr double begun_fraction = 0.1;    // of that rise
constexpr double sensor_delay_s = 0.003;  // standard deviation of what is left of the sensor's lag
constexpr double min_landing_sigma_s = 0.002;
constexpr double unrelated_fraction = 0.1;  // of first contacts, which have another cause

double square(double value) { return value * value; }

/// Probability that a standard normal variable is below `x`.
double normal_below(double x) { return 0.5 * std::erfc(-x * std::sqrt(0.5)); }

/// Frames of a glove with their mid-scan times.
class TouchSeries {
 public:
  TouchSeries(const GloveStream& glove, const Timeline& timeline) : glove_(glove) {
    for (const auto sequence : glove.sequence) time_s_.push_back(timeline.glove_time_s(sequence));
  }

  double time_s(std::size_t frame) const { return time_s_[frame]; }
  /// First frame at or after a time.
  std::size_t frame_after(double time_s) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(time_s_, time_s) - time_s_.begin());
  }
  /// Counts above the unloaded ones, summed over a row.
  double row_sum(std::size_t frame, int row) const {
    const auto& info = glove_.info;
    double sum = 0.0;
    for (int col = 0; col < info.cols; ++col) {
      const auto taxel = static_cast<std::size_t>(row * info.cols + col);
      if (info.mask[taxel])
        sum += info.polarity *
               (glove_.counts[frame * static_cast<std::size_t>(info.taxels()) + taxel] -
                static_cast<double>(info.baseline_counts[taxel]));
    }
    return sum;
  }
  double sum(std::size_t frame) const {
    double sum = 0.0;
    for (int row = 0; row < glove_.info.rows; ++row) sum += row_sum(frame, row);
    return sum;
  }
  /// When the rows that differ between two frames are read, relative to the middle of a scan.
  double read_offset_s(std::size_t before, std::size_t after) const {
    const int rows = glove_.info.rows;
    double weight = 0.0, moment = 0.0;
    for (int row = 0; row < rows; ++row) {
      const double rise = std::max(0.0, row_sum(after, row) - row_sum(before, row));
      weight += rise, moment += rise * ((row + 0.5) / rows - 0.5);
    }
    return weight > 0.0 ? glove_.info.scan_s * moment / weight : 0.0;
  }

 private:
  const GloveStream& glove_;
  std::vector<double> time_s_;
};

/// Contact began within this interval.
struct FirstContact {
  double from_s, to_s;
};

/// First contact around a landing at `stamp_s`, which is late by the camera's latency.
std::optional<FirstContact> first_contact(const TouchSeries& touch, double stamp_s) {
  const std::size_t begin = touch.frame_after(stamp_s - max_latency_s - 0.1),
                    landed = touch.frame_after(stamp_s);
  if (begin >= landed) return std::nullopt;
  std::vector<double> sums;
  for (std::size_t i = begin; i < touch.frame_after(stamp_s + rise_s); ++i)
    sums.push_back(touch.sum(i));
  const auto flying = std::min_element(sums.begin(), sums.begin() + std::ptrdiff_t(landed - begin));
  const double firm = *std::max_element(flying, sums.end());
  const auto touched = std::find_if(flying, sums.end(), [&](double sum) {
    return sum > *flying + begun_fraction * (firm - *flying);
  });
  if (touched == sums.end() || touched == flying) return std::nullopt;
  const std::size_t first = begin + std::size_t(touched - sums.begin());
  const std::size_t next = std::min(first + 1, begin + sums.size() - 1);
  const double offset_s = touch.read_offset_s(begin + std::size_t(flying - sums.begin()), next);
  return FirstContact{touch.time_s(first - 1) + offset_s, touch.time_s(first) + offset_s};
}

/// Logarithm of the likelihood of latencies on a grid.
class LatencyLikelihood {
 public:
  /// `stamp_s`: of a landing with that standard deviation.
  void add(double stamp_s, double sigma_s, const FirstContact& contact) {
    const double width_s = contact.to_s - contact.from_s;
    const double unrelated = unrelated_fraction * width_s / (max_latency_s + rise_s);
    for (std::size_t i = 0; i < log_.size(); ++i) {
      const double landing_s = stamp_s - latency_s(i);
      const double between = normal_below((contact.to_s - landing_s) / sigma_s) -
                             normal_below((contact.from_s - landing_s) / sigma_s);
      log_[i] += std::log((1.0 - unrelated_fraction) * between + unrelated);
    }
  }
  /// Mean and standard deviation with a uniform prior.
  std::pair<double, double> posterior() const {
    const double highest = *std::ranges::max_element(log_);
    double weight = 0.0, mean = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < log_.size(); ++i) {
      const double w = std::exp(log_[i] - highest);
      weight += w, mean += w * latency_s(i), squares += w * square(latency_s(i));
    }
    mean /= weight;
    return {mean, std::sqrt(std::max(0.0, squares / weight - square(mean)))};
  }

 private:
  static double latency_s(std::size_t i) { return latency_step_s * static_cast<double>(i); }

  std::vector<double> log_ = std::vector<double>(std::size_t(max_latency_s / latency_step_s) + 1);
};

/// Whether most flights end with a hit that begins the next one. A hand with a racket touches all
/// the time, and flights that seem to end otherwise are followed by one that was not found.
bool is_mostly_hit(const std::vector<SmoothedTrack>& object_tracks) {
  std::size_t flights = 0, hits = 0;
  for (const SmoothedTrack& track : object_tracks)
    for (std::size_t i = 0; i < track.flights.size(); ++i, ++flights)
      hits += i > 0 && track.flights[i].release_s == track.flights[i - 1].landing_s;
  return 2 * hits > flights;
}

}  // namespace

std::optional<LatencyEstimate> latency_from_catches(
    const GloveStream& glove, const Timeline& timeline,
    const std::vector<SmoothedTrack>& object_tracks) {
  if (glove.counts.empty() || is_mostly_hit(object_tracks)) return std::nullopt;
  const TouchSeries touch(glove, timeline);
  LatencyLikelihood likelihood;
  int num_catches = 0;
  for (const SmoothedTrack& track : object_tracks)
    for (const Flight& flight : track.flights) {
      const double stamp_s = flight.landing_s + timeline.latency_s;
      const auto contact = first_contact(touch, stamp_s);
      if (!contact) continue;
      likelihood.add(stamp_s, std::max(flight.landing_distribution.sigma_s(), min_landing_sigma_s),
                     *contact);
      ++num_catches;
    }
  if (num_catches == 0) return std::nullopt;
  const auto [latency_s, sigma_s] = likelihood.posterior();
  const double scan_s =
      glove.info.scan_s > 0.0 ? 0.0 : 1.0 / (glove.info.rate_hz * std::sqrt(12.0));
  const double total_s = std::hypot(sigma_s, sensor_delay_s, scan_s);
  if (total_s > 0.5 * timeline.latency_sigma_s) return std::nullopt;
  return LatencyEstimate{latency_s, total_s, fmt::format("{} catches", num_catches)};
}

}  // namespace touchtrace::label
