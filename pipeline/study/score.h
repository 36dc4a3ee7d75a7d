#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "pipeline/study/band.h"
#include "pipeline/study/metrics.h"
#include "pipeline/study/rollouts.h"

namespace touchtrace::study {

/// Metrics of one roll-out.
struct CaseScore {
  double l1_at_20, l1_at_50, hausdorff;   ///< normalised units
  double object_m_at_20, object_m_at_50;  ///< mean position error over steps 1..N
  double hand_m_at_20, hand_m_at_50;
  std::vector<double> l1_by_step;  ///< [steps]
};

/// [cases] Scores of paths [cases, steps, 12], which are normalised by `scaling` like the cases.
/// Throws failure if a value is not finite.
std::vector<CaseScore> score(const std::vector<float>& paths, const RolloutCases& cases,
                             const Normalization& scaling);

/// Means over the roll-outs `which`: fields of a row of `results`. Undefined values are NaN (null
/// in JSON text).
nlohmann::json summary(const std::vector<CaseScore>& scores, const std::vector<int>& which);
/// [steps] Mean L1 over the roll-outs `which`.
std::vector<double> mean_curve(const std::vector<CaseScore>& scores, const std::vector<int>& which);

/// Mean of the values that are not NaN; NaN if there are none.
double nan_mean(const std::vector<double>& values);

/// Mean of (a - b) over roll-outs with its 95 % interval from 2000 bootstrap samples of whole
/// clips.
struct Difference {
  double mean, low, high;
};
Difference bootstrap_difference(const std::vector<double>& a, const std::vector<double>& b,
                                const std::vector<int>& clip, std::uint64_t seed);

}  // namespace touchtrace::study
