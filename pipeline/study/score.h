#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "pipeline/study/metrics.h"
#include "pipeline/study/rollouts.h"

namespace touchtrace::study {

/// Errors of one body in a roll-out. Means over steps 1..N of distances.
struct BodyScore {
  double m_at_20, m_at_50;              ///< of positions
  double m_per_s_at_20, m_per_s_at_50;  ///< of velocities
  double hausdorff_m;                   ///< of the two sets of positions
};

/// Metrics of one roll-out, over steps with a positive weight; NaN if there are none.
struct CaseScore {
  double l1_at_20, l1_at_50, hausdorff;  ///< normalised units
  BodyScore object, hand;
  std::vector<double> l1_by_step;  ///< [steps], NaN at steps of weight 0
};

/// Metric of CaseScore: its name in `results`. The smaller, the better.
struct Metric {
  const char* name;
  double (*value)(const CaseScore&);
};
std::span<const Metric> all_metrics();

/// [cases] Scores of paths [cases, steps, 12], which are normalised by `scaling` like the cases.
/// Throws failure if a value is not finite.
std::vector<CaseScore> score(const std::vector<float>& paths, const RolloutCases& cases,
                             const Normalization& scaling);

/// Means over the roll-outs `which` by metric. Undefined values are NaN (null in JSON text).
nlohmann::json summary(const std::vector<CaseScore>& scores, const std::vector<int>& which);
/// [steps] Mean L1 over the roll-outs `which`.
std::vector<double> mean_curve(const std::vector<CaseScore>& scores, const std::vector<int>& which);

/// Mean of the values that are not NaN; NaN if there are none.
double nan_mean(const std::vector<double>& values);

}  // namespace touchtrace::study
