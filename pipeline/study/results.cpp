#include "pipeline/study/results.h"

#include <algorithm>

namespace touchtrace::study {
namespace {

using nlohmann::json;

json key_of(const Comparison& comparison, const std::string& object) {
  const auto& seen = comparison.card().objects;
  const bool known = std::ranges::find(seen, object) != seen.end();
  return {{"activity", comparison.card().activity},
          {"object", object},
          {"split", known ? "seen" : "unseen"}};
}

json metrics(const Candidate& candidate, const std::vector<CaseScore>& scores,
             const RolloutCases& cases, const std::vector<int>& which) {
  json row = summary(scores, which);
  row["coverage"] = nan_mean(coverage_of(candidate, cases, which, true));
  row["coverage_raw"] = nan_mean(coverage_of(candidate, cases, which, false));
  return row;
}

json result(const Comparison& comparison, const Candidate& candidate, const std::string& object,
            const std::vector<int>& which) {
  json row = key_of(comparison, object);
  row["model"] = candidate.name;
  row["rollouts"] = which.size();
  row.update(metrics(candidate, candidate.scores, comparison.cases, which));
  if (comparison.reference == Reference::truth)
    row["against_labels"] =
        metrics(candidate, candidate.label_scores, comparison.label_cases, which);
  return row;
}

json curve(const Comparison& comparison, const Candidate& candidate, const std::string& object,
           const std::vector<int>& which) {
  json row = key_of(comparison, object);
  row["model"] = candidate.name;
  row["l1_by_step"] = mean_curve(candidate.scores, which);
  if (candidate.model) {
    row["nominal_coverage"] = nominal_coverage(candidate.model->card.spec.band_quantile);
    row["coverage_by_step"] = coverage_of(candidate, comparison.cases, which, true);
    row["coverage_raw_by_step"] = coverage_of(candidate, comparison.cases, which, false);
  }
  return row;
}

std::vector<double> values_of(const Candidate& candidate, double CaseScore::*member,
                              const std::vector<int>& which) {
  std::vector<double> values;
  for (int i : which) values.push_back(candidate.scores[i].*member);
  return values;
}

/// full - `other`
json difference(const Comparison& comparison, const std::string& other, const std::string& object,
                const std::vector<int>& which, const char* metric, double CaseScore::*member,
                std::uint64_t seed) {
  std::vector<int> clips;
  for (int i : which) clips.push_back(comparison.cases.sequence[i]);
  const Difference found =
      bootstrap_difference(values_of(*comparison.find("full"), member, which),
                           values_of(*comparison.find(other), member, which), clips, seed);
  json row = key_of(comparison, object);
  row.update({{"other", other},
              {"metric", metric},
              {"mean", found.mean},
              {"low", found.low},
              {"high", found.high}});
  return row;
}

}  // namespace

void append_results(json& document, const Comparison& comparison, std::uint64_t seed) {
  for (const auto& [object, which] : comparison.objects()) {
    for (const Candidate& candidate : comparison.candidates) {
      document["results"].push_back(result(comparison, candidate, object, which));
      document["curves"].push_back(curve(comparison, candidate, object, which));
    }
    for (const char* other : {"without_touch", "without_embedding"}) {
      if (!comparison.find("full") || !comparison.find(other)) continue;
      const auto add = [&, &cases = which, &name = object](const char* metric,
                                                           double CaseScore::*member) {
        document["differences"].push_back(
            difference(comparison, other, name, cases, metric, member, seed));
      };
      add("l1_at_20", &CaseScore::l1_at_20);
      add("l1_at_50", &CaseScore::l1_at_50);
      add("hausdorff", &CaseScore::hausdorff);
    }
  }
}

}  // namespace touchtrace::study
