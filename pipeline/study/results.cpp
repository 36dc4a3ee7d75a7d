#include "pipeline/study/results.h"

#include <algorithm>
#include <map>
#include <set>

#include "pipeline/study/bootstrap.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;

/// Roll-outs of one object, or of all objects of a split.
struct Group {
  std::string object, split;
  std::vector<int> which;
};

std::string split_of(const Comparison& comparison, const std::string& object) {
  int seen = 0, models = 0;
  for (const Candidate& candidate : comparison.candidates)
    for (const Run& run : candidate.runs) {
      if (!run.model) continue;
      ++models;
      seen += std::ranges::count(run.model->card.objects, object) > 0;
    }
  return seen == models ? "seen" : seen == 0 ? "unseen" : "mixed";
}

/// Objects, then the union of the objects of each split that has several.
std::vector<Group> groups_of(const Comparison& comparison) {
  std::vector<Group> groups;
  for (const auto& [object, which] : comparison.objects())
    groups.push_back({object, split_of(comparison, object), which});
  const std::vector<Group> objects = groups;
  for (const char* split : {"seen", "unseen", "mixed"}) {
    if (std::ranges::count(objects, split, &Group::split) < 2) continue;
    Group all{"all", split, {}};
    for (const Group& group : objects)
      if (group.split == split)
        all.which.insert(all.which.end(), group.which.begin(), group.which.end());
    groups.push_back(std::move(all));
  }
  return groups;
}

/// A comparison, and the roll-outs and bootstrap seed of its rows.
class Rows {
 public:
  Rows(const Comparison& comparison, const Group& group, std::uint64_t seed)
      : comparison_(comparison), group_(group), seed_(seed) {
    for (int i : group.which) clip_.push_back(comparison.cases().sequence[i]);
  }

  json result(const Candidate& candidate) const {
    json row = head(candidate);
    row["runs"] = candidate.is_baseline() ? 0 : candidate.runs.size();
    row["clips"] = std::set(clip_.begin(), clip_.end()).size();
    row["rollouts"] = group_.which.size();
    row.update(metrics(candidate, 0));
    for (std::size_t t = 1; t < comparison_.targets.size(); ++t)
      row["against_" + comparison_.targets[t].name] = metrics(candidate, t);
    return row;
  }

  json run(const Candidate& candidate, const Run& run) const {
    json row = head(candidate);
    row["file"] = run.model->path;
    const Provenance& training = run.model->card.provenance;
    row["seed"] = training.seed;
    row["training_cpu_seconds"] = training.cpu_seconds;
    row.update(summary(run.scores.front(), group_.which));
    row.update(coverages(run, 0));
    return row;
  }

  json curve(const Candidate& candidate) const {
    const auto mean_over_runs = [&](auto values_of_run) {
      std::vector<std::vector<double>> runs;
      for (const Run& run : candidate.runs) runs.push_back(values_of_run(run));
      std::vector<double> mean;
      for (std::size_t step = 0; step < runs.front().size(); ++step) {
        std::vector<double> values;
        for (const auto& one : runs) values.push_back(one[step]);
        mean.push_back(nan_mean(values));
      }
      return mean;
    };
    json row = head(candidate);
    row["l1_by_step"] = mean_over_runs(
        [&](const Run& run) { return mean_curve(run.scores.front(), group_.which); });
    if (candidate.is_baseline()) return row;
    const ModelCard& card = candidate.runs.front().model->card;
    row["nominal_coverage"] = nominal_coverage(card.spec.band_quantile);
    row["coverage_raw_by_step"] = mean_over_runs(
        [&](const Run& run) { return coverage_of(run, comparison_.cases(), group_.which, false); });
    if (!card.band_scale.empty())
      row["coverage_by_step"] = mean_over_runs([&](const Run& run) {
        return coverage_of(run, comparison_.cases(), group_.which, true);
      });
    return row;
  }

  json difference(const Candidate& full, const Candidate& other) const {
    json row = head(full);
    row["other"] = other.name;
    for (const Metric& metric : all_metrics()) {
      const Interval found =
          bootstrap_difference(values(full, metric, 0), values(other, metric, 0), clip_, seed_);
      row["metrics"][metric.name] = {
          {"mean", found.mean}, {"low", found.low}, {"high", found.high}};
    }
    return row;
  }

 private:
  json head(const Candidate& candidate) const {
    return {{"activity", comparison_.sessions.front()->data.activity},
            {"object", group_.object},
            {"split", group_.split},
            {"model", candidate.name},
            {"kind", candidate.kind},
            {"options", candidate.options}};
  }

  RunValues values(const Candidate& candidate, const Metric& metric, std::size_t target) const {
    RunValues runs;
    for (const Run& run : candidate.runs) {
      auto& row = runs.emplace_back();
      for (int i : group_.which) row.push_back(metric.value(run.scores[target][i]));
    }
    return runs;
  }

  /// Over both horizons; rescaled only with a band scale.
  json coverages(const Run& run, std::size_t target) const {
    json row;
    for (const bool scaled : {false, true}) {
      if (scaled && (!run.model || run.model->card.band_scale.empty())) continue;
      auto steps = coverage_of(run, comparison_.targets[target].cases, group_.which, scaled);
      const std::string name = scaled ? "coverage" : "coverage_raw";
      row[name] = nan_mean(steps);
      steps.resize(std::min<std::size_t>(steps.size(), short_horizon_steps));
      row[name + "_at_20"] = nan_mean(steps);
    }
    return row;
  }

  /// Means over runs; null where no run has the coverage.
  json mean_coverages(const Candidate& candidate, std::size_t target) const {
    std::map<std::string, std::vector<double>> values{
        {"coverage", {}}, {"coverage_at_20", {}}, {"coverage_raw", {}}, {"coverage_raw_at_20", {}}};
    for (const Run& run : candidate.runs) {
      const json found = coverages(run, target);
      for (const auto& [name, value] : found.items()) values.at(name).push_back(value);
    }
    json row;
    for (const auto& [name, of_runs] : values) row[name] = nan_mean(of_runs);
    return row;
  }

  json metrics(const Candidate& candidate, std::size_t target) const {
    json row;
    for (const Metric& metric : all_metrics()) {
      const Interval found = bootstrap_mean(values(candidate, metric, target), clip_, seed_);
      row[metric.name] = found.mean;
      row["intervals"][metric.name] = {found.low, found.high};
    }
    row.update(mean_coverages(candidate, target));
    return row;
  }

  const Comparison& comparison_;
  const Group& group_;
  std::uint64_t seed_;
  std::vector<int> clip_;  ///< [roll-outs of the group]
};

void append_differences(json& document, const Comparison& comparison, const Rows& rows) {
  for (const Candidate& full : comparison.candidates)
    for (const Candidate& other : comparison.candidates)
      if (full.kind == "full" &&
          (other.kind == "without_touch" || other.kind == "without_embedding" ||
           other.kind == "hold" ||
           (other.kind == other_touch_kind && other.options == full.options)))
        document["differences"].push_back(rows.difference(full, other));
}

}  // namespace

void append_results(json& document, const Comparison& comparison, std::uint64_t seed) {
  for (const Group& group : groups_of(comparison)) {
    const Rows rows(comparison, group, seed);
    for (const Candidate& candidate : comparison.candidates) {
      document["results"].push_back(rows.result(candidate));
      document["curves"].push_back(rows.curve(candidate));
      for (const Run& run : candidate.runs)
        if (run.model) document["runs"].push_back(rows.run(candidate, run));
    }
    append_differences(document, comparison, rows);
  }
}

}  // namespace touchtrace::study
