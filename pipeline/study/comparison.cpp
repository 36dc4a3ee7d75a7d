#include "pipeline/study/comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "engine/base/error.h"

namespace touchtrace::study {
namespace {

template <class T>
void join(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append(RolloutCases& pool, const RolloutCases& cases, int first_sequence) {
  join(pool.batch.first_frame, cases.batch.first_frame);
  join(pool.batch.initial_state, cases.batch.initial_state);
  join(pool.batch.target, cases.batch.target);
  join(pool.batch.weight, cases.batch.weight);
  pool.batch.sequences += cases.batch.sequences;
  pool.batch.steps = cases.batch.steps;
  for (int sequence : cases.sequence) pool.sequence.push_back(first_sequence + sequence);
}

RolloutGrid grid_of(int history, int stride) {
  return {Split::evaluation, horizon_steps, stride, history};
}

void pool_cases(Comparison& comparison, int stride) {
  int first_sequence = 0;
  const RolloutGrid grid = grid_of(comparison.history, stride);
  for (int s = 0; s < static_cast<int>(comparison.sessions.size()); ++s) {
    const Dataset& data = comparison.sessions[s]->data;
    const RolloutCases cases = make_cases(data, grid, comparison.scaling, comparison.reference);
    append(comparison.cases, cases, first_sequence);
    append(comparison.label_cases, make_cases(data, grid, comparison.scaling, Reference::labels),
           first_sequence);
    comparison.session.insert(comparison.session.end(), static_cast<std::size_t>(cases.count()), s);
    for (int sequence : cases.sequence)
      comparison.object.push_back(data.sequences[sequence].object);
    first_sequence += static_cast<int>(data.sequences.size());
  }
}

Rollout roll_out(const LoadedModel& model, const Comparison& comparison, int stride) {
  Rollout all;
  for (const Session* session : comparison.sessions) {
    const auto cases = make_cases(session->data, grid_of(comparison.history, stride),
                                  model.card.scaling, Reference::labels);
    const Rollout rollout = model.predictor->predict(cases.batch, session->data.tactile);
    join(all.state, rollout.state);
    join(all.spread, rollout.spread);
  }
  return rescaled(all, model.card.scaling, comparison.scaling);
}

/// Selects the rows `which` of [cases, row].
std::vector<float> rows_of(const std::vector<float>& values, const std::vector<int>& which,
                           std::size_t row) {
  std::vector<float> picked;
  for (int i : which) {
    const auto first =
        values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(i) * row);
    picked.insert(picked.end(), first, first + static_cast<std::ptrdiff_t>(row));
  }
  return picked;
}

}  // namespace

const Candidate* Comparison::find(const std::string& name) const {
  const auto found = std::ranges::find(candidates, name, &Candidate::name);
  return found == candidates.end() ? nullptr : &*found;
}

std::vector<std::pair<std::string, std::vector<int>>> Comparison::objects() const {
  std::map<std::string, std::vector<int>> found;
  for (int i = 0; i < cases.count(); ++i) found[object[i]].push_back(i);
  return {found.begin(), found.end()};
}

Comparison compare_models(const std::vector<const Session*>& sessions,
                          const std::vector<LoadedModel*>& models, Reference reference, int stride,
                          std::uint64_t seed) {
  Comparison comparison;
  comparison.sessions = sessions;
  comparison.reference = reference;
  comparison.scaling = models.front()->card.scaling;
  for (const LoadedModel* model : models)
    comparison.history = std::max(comparison.history, required_history(model->card.spec));
  pool_cases(comparison, stride);
  if (comparison.cases.count() < 2)
    throw data_error(
        fmt::format("the evaluation clips of {} hold fewer than two roll-outs of {} steps",
                    models.front()->card.activity, horizon_steps),
        "record more or longer clips");
  comparison.candidates.push_back(
      {"random", nullptr, {random_paths(comparison.cases, seed), {}}, {}, {}});
  for (const LoadedModel* model : models)
    comparison.candidates.push_back(
        {model->card.name(), model, roll_out(*model, comparison, stride), {}, {}});
  for (Candidate& candidate : comparison.candidates) {
    candidate.scores = score(candidate.rollout.state, comparison.cases, comparison.scaling);
    candidate.label_scores =
        score(candidate.rollout.state, comparison.label_cases, comparison.scaling);
  }
  return comparison;
}

std::vector<double> coverage_of(const Candidate& candidate, const RolloutCases& cases,
                                const std::vector<int>& which, bool scaled) {
  if (!candidate.model) return {};
  const std::size_t size = cases.path_size(), steps = static_cast<std::size_t>(cases.batch.steps);
  const RolloutBatch batch{static_cast<int>(which.size()),
                           cases.batch.steps,
                           {},
                           {},
                           rows_of(cases.batch.target, which, size),
                           rows_of(cases.batch.weight, which, steps)};
  const Rollout rollout{rows_of(candidate.rollout.state, which, size),
                        rows_of(candidate.rollout.spread, which, size)};
  return coverage_by_step(rollout, batch, scaled ? candidate.model->card.band_scale : BandScale{});
}

}  // namespace touchtrace::study
