#include <algorithm>
#include <cmath>

#include "engine/base/base64.h"
#include "pipeline/study/results.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;

template <class Unscale>
nlohmann::json rows_of(const float* scaled, int steps, Unscale unscale) {
  nlohmann::json rows = nlohmann::json::array();
  for (int step = 0; step < steps; ++step) {
    nlohmann::json row = nlohmann::json::array();
    for (int d = 0; d < state_size; ++d) row.push_back(unscale(scaled[step * state_size + d], d));
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Frames first .. first + count - 1 as base64 of bytes; 255: full pressure.
json tactile_json(const Dataset& data, int first, int count, int first_step) {
  const std::size_t frame_size =
      static_cast<std::size_t>(data.rows) * static_cast<std::size_t>(data.cols);
  const auto pressure = std::span(data.tactile)
                            .subspan(static_cast<std::size_t>(first) * frame_size,
                                     static_cast<std::size_t>(count) * frame_size);
  std::vector<std::uint8_t> bytes;
  for (float value : pressure)
    bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f))));
  return {{"rows", data.rows},
          {"cols", data.cols},
          {"first_step", first_step},
          {"data", base64(bytes)}};
}

json states_json(const float* scaled, int steps, const Normalization& scaling) {
  return rows_of(scaled, steps,
                 [&](float value, int d) { return value * scaling.sigma[d] + scaling.mean[d]; });
}

json spreads_json(const float* scaled, int steps, const Normalization& scaling) {
  return rows_of(scaled, steps, [&](float value, int d) { return value * scaling.sigma[d]; });
}

json model_json(const Comparison& comparison, const Candidate& candidate, std::size_t at) {
  const int steps = comparison.cases().batch.steps;
  const Run& run = candidate.runs.front();
  const Rollout scaled = with_scaled_band(run.rollout, steps, run.model->card.band_scale);
  return {{"state", states_json(&scaled.state[at], steps, comparison.scaling)},
          {"spread", spreads_json(&scaled.spread[at], steps, comparison.scaling)}};
}

const Sequence& sequence_at(const Dataset& data, int frame) {
  return *std::ranges::find_if(data.sequences, [&](const Sequence& s) {
    return s.first_frame <= frame && frame < s.first_frame + s.frames;
  });
}

json example(const Comparison& comparison, const std::string& rank, int i, double l1_at_50) {
  const RolloutBatch& batch = comparison.cases().batch;
  const Session& session = *comparison.sessions[comparison.session[i]];
  const Dataset& data = session.data;
  const int start = batch.first_frame[i];
  const Sequence& clip = sequence_at(data, start);
  const std::size_t at = static_cast<std::size_t>(i) * comparison.cases().path_size();
  json row{{"activity", data.activity},
           {"object", comparison.object[i]},
           {"recording", session.name},
           {"clip", clip.clip},
           {"start_s", (start - clip.first_frame) / data.rate_hz},
           {"rank", rank},
           {"l1_at_50", l1_at_50},
           {"rate_hz", data.rate_hz},
           {"target", states_json(&batch.target[at], batch.steps, comparison.scaling)}};
  for (const Candidate& candidate : comparison.candidates)
    if (!candidate.is_baseline() && comparison.find(candidate.kind) == &candidate)
      row["models"][candidate.kind] = model_json(comparison, candidate, at);
  row["tactile"] = tactile_json(data, start - comparison.history + 1,
                                comparison.history + batch.steps, 1 - comparison.history);
  return row;
}

/// Indices of the quantiles `shares` of `values`, NaN excluded.
std::vector<int> at_shares(const std::vector<double>& values, const std::vector<double>& shares) {
  std::vector<int> order, found;
  for (int i = 0; i < static_cast<int>(values.size()); ++i)
    if (!std::isnan(values[i])) order.push_back(i);
  std::ranges::sort(order, {}, [&](int i) { return values[i]; });
  for (double share : shares)
    if (!order.empty())
      found.push_back(
          order[static_cast<std::size_t>(share * static_cast<double>(order.size() - 1))]);
  return found;
}

}  // namespace

void append_examples(json& document, const Comparison& comparison) {
  static const std::vector<std::string> ranks{"median", "best", "worst"};
  const Candidate* full = comparison.find("full");
  const Candidate& judge = full ? *full : comparison.candidates.back();
  std::vector<double> errors;
  for (const CaseScore& one : judge.runs.front().scores.front()) errors.push_back(one.l1_at_50);
  const auto chosen = at_shares(errors, {0.5, 0.0, 1.0});
  for (std::size_t k = 0; k < chosen.size(); ++k)
    document["examples"].push_back(example(comparison, ranks[k], chosen[k], errors[chosen[k]]));
}

}  // namespace touchtrace::study
