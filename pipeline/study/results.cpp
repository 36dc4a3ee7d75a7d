#include "pipeline/study/results.h"

#include <algorithm>

namespace touchtrace::study {
namespace {

using nlohmann::json;

json key_of(const Contest& contest, const std::string& object) {
  const auto& seen = contest.card().objects;
  const bool known = std::ranges::find(seen, object) != seen.end();
  return {{"activity", contest.card().activity},
          {"object", object},
          {"split", known ? "seen" : "unseen"}};
}

json metrics(const Contender& contender, const std::vector<CaseScore>& scores,
             const RolloutCases& cases, const std::vector<int>& which) {
  json row = summary(scores, which);
  row["coverage"] = mean_known(coverage_of(contender, cases, which, true));
  row["coverage_raw"] = mean_known(coverage_of(contender, cases, which, false));
  return row;
}

json result(const Contest& contest, const Contender& contender, const std::string& object,
            const std::vector<int>& which) {
  json row = key_of(contest, object);
  row["model"] = contender.name;
  row["rollouts"] = which.size();
  row.update(metrics(contender, contender.scores, contest.cases, which));
  if (contest.reference == Reference::truth)
    row["against_labels"] = metrics(contender, contender.label_scores, contest.label_cases, which);
  return row;
}

json curve(const Contest& contest, const Contender& contender, const std::string& object,
           const std::vector<int>& which) {
  json row = key_of(contest, object);
  row["model"] = contender.name;
  row["l1_by_step"] = mean_curve(contender.scores, which);
  if (contender.model) {
    row["nominal_coverage"] = nominal_coverage(contender.model->card.spec.band_quantile);
    row["coverage_by_step"] = coverage_of(contender, contest.cases, which, true);
    row["coverage_raw_by_step"] = coverage_of(contender, contest.cases, which, false);
  }
  return row;
}

std::vector<double> values_of(const Contender& contender, double CaseScore::*member,
                              const std::vector<int>& which) {
  std::vector<double> values;
  for (int i : which) values.push_back(contender.scores[i].*member);
  return values;
}

/// full - `other`
json difference(const Contest& contest, const std::string& other, const std::string& object,
                const std::vector<int>& which, const char* metric, double CaseScore::*member,
                std::uint64_t seed) {
  std::vector<int> clips;
  for (int i : which) clips.push_back(contest.cases.sequence[i]);
  const Difference found =
      bootstrap_difference(values_of(*contest.find("full"), member, which),
                           values_of(*contest.find(other), member, which), clips, seed);
  json row = key_of(contest, object);
  row.update({{"other", other},
              {"metric", metric},
              {"mean", found.mean},
              {"low", found.low},
              {"high", found.high}});
  return row;
}

}  // namespace

void append_results(json& document, const Contest& contest, std::uint64_t seed) {
  for (const auto& [object, which] : contest.objects()) {
    for (const Contender& contender : contest.contenders) {
      document["results"].push_back(result(contest, contender, object, which));
      document["curves"].push_back(curve(contest, contender, object, which));
    }
    for (const char* other : {"without_touch", "without_embedding"}) {
      if (!contest.find("full") || !contest.find(other)) continue;
      const auto add = [&, &cases = which, &name = object](const char* metric,
                                                           double CaseScore::*member) {
        document["differences"].push_back(
            difference(contest, other, name, cases, metric, member, seed));
      };
      add("l1_at_20", &CaseScore::l1_at_20);
      add("l1_at_50", &CaseScore::l1_at_50);
      add("hausdorff", &CaseScore::hausdorff);
    }
  }
}

}  // namespace touchtrace::study
