#include "pipeline/study/comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "engine/base/error.h"
#include "engine/base/interrupt.h"
#include "pipeline/study/averaged_images.h"
#include "pipeline/study/baselines.h"

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

/// Cases of all sessions.
RolloutCases pool_cases(const Comparison& comparison, Reference reference,
                        const RolloutGrid& grid) {
  RolloutCases pool;
  int first_sequence = 0;
  for (const Session* session : comparison.sessions) {
    append(pool, make_cases(session->data, grid, comparison.scaling, reference), first_sequence);
    first_sequence += static_cast<int>(session->data.sequences.size());
  }
  return pool;
}

RolloutGrid grid_of(const Comparison& comparison, Split split, int stride) {
  return {split, horizon_steps, stride, comparison.history};
}

[[noreturn]] void reject_clips(const Comparison& comparison) {
  int clips = 0, longest = 0;
  for (const Session* session : comparison.sessions)
    for (const Sequence& clip : session->data.sequences)
      if (clip.split == Split::evaluation) ++clips, longest = std::max(longest, clip.frames);
  throw data_error(
      fmt::format("{} evaluation clips of {}, the longest of {} frames, hold fewer than two "
                  "roll-outs: each needs {} frames of touch, a good label, and {} further frames",
                  clips, comparison.sessions.front()->data.activity, longest, comparison.history,
                  horizon_steps),
      "record longer clips or more of them (every fifth is for evaluation), or evaluate recordings "
      "that no model was trained on: all of their clips count");
}

void add_targets(Comparison& comparison, Reference reference, int stride) {
  const auto add = [&](const char* name, Reference source) {
    comparison.targets.push_back(
        {name, pool_cases(comparison, source, grid_of(comparison, Split::evaluation, stride))});
  };
  if (reference == Reference::truth) add("truth", reference);
  add("labels", Reference::labels);
  if (reference == Reference::truth) add("unshifted_truth", Reference::unshifted_truth);
  for (int s = 0; s < static_cast<int>(comparison.sessions.size()); ++s) {
    const Dataset& data = comparison.sessions[s]->data;
    for (const Start& start : find_starts(data, grid_of(comparison, Split::evaluation, stride))) {
      comparison.session.push_back(s);
      comparison.object.push_back(data.sequences[start.sequence].object);
    }
  }
}

/// Which touch a model gets.
enum class Touch { own, of_other_rollouts };

/// Gives each roll-out the touch of the one that is half of all away. States and objects stay. A
/// single roll-out keeps its own.
void exchange_touch(RolloutBatch& batch) {
  auto& frames = batch.first_frame;
  std::ranges::rotate(frames, frames.begin() + static_cast<std::ptrdiff_t>(frames.size() / 2));
}

Rollout predict(const LoadedModel& model, const RolloutBatch& batch, const Session& session) {
  const auto images = averaged_images(model.card.spec, model.path, session.data, session.name);
  return model.predictor->predict(batch, images ? *images : session.data.tactile);
}

Rollout roll_out(const LoadedModel& model, const Comparison& comparison, int stride, Touch touch) {
  Rollout all;
  for (const Session* session : comparison.sessions) {
    throw_if_interrupted();
    auto cases = make_cases(session->data, grid_of(comparison, Split::evaluation, stride),
                            model.card.scaling, Reference::labels);
    if (touch == Touch::of_other_rollouts) exchange_touch(cases.batch);
    const Rollout rollout = predict(model, cases.batch, *session);
    if (!is_finite(rollout))
      throw failure(fmt::format("{} predicts values that are not finite", model.path),
                    "train it again with a lower --learning-rate");
    join(all.state, rollout.state);
    join(all.spread, rollout.spread);
  }
  return rescaled(all, model.card.scaling, comparison.scaling);
}

/// Cases without the steps at which a path is unknown.
RolloutCases masked(RolloutCases cases, const std::vector<float>& path_weight) {
  for (std::size_t i = 0; i < path_weight.size(); ++i) cases.batch.weight[i] *= path_weight[i];
  return cases;
}

Run scored(Run run, const Comparison& comparison, const std::vector<float>& path_weight = {}) {
  for (const Target& target : comparison.targets)
    run.scores.push_back(
        score(run.rollout.state, masked(target.cases, path_weight), comparison.scaling));
  return run;
}

void add_baselines(Comparison& comparison, int stride, std::uint64_t seed) {
  const double step_s = 1.0 / comparison.sessions.front()->data.rate_hz;
  const RolloutCases training =
      pool_cases(comparison, Reference::labels, grid_of(comparison, Split::train, stride));
  for (Baseline& baseline :
       make_baselines(comparison.cases(), training, comparison.scaling, step_s, seed))
    comparison.candidates.push_back(
        {baseline.name,
         baseline.name,
         {scored({nullptr, {std::move(baseline.paths), {}}, {}}, comparison, baseline.weight)}});
}

Candidate rolled_out(const ModelGroup& group, const Comparison& comparison, int stride,
                     Touch touch) {
  Candidate candidate{group.name, group.kind, {}, group.options};
  for (const LoadedModel* model : group.models)
    candidate.runs.push_back(
        scored({model, roll_out(*model, comparison, stride, touch), {}}, comparison));
  return candidate;
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

const Candidate* Comparison::find(const std::string& kind) const {
  const auto found = std::ranges::find(candidates, kind, &Candidate::kind);
  return found == candidates.end() ? nullptr : &*found;
}

std::vector<std::pair<std::string, std::vector<int>>> Comparison::objects() const {
  std::map<std::string, std::vector<int>> found;
  for (int i = 0; i < cases().count(); ++i) found[object[i]].push_back(i);
  return {found.begin(), found.end()};
}

Comparison compare_models(const std::vector<const Session*>& sessions,
                          const std::vector<LoadedModel*>& models, Reference reference, int stride,
                          std::uint64_t seed) {
  Comparison comparison;
  comparison.sessions = sessions;
  comparison.scaling = models.front()->card.scaling;
  for (const LoadedModel* model : models)
    comparison.history = std::max(comparison.history, required_history(model->card.spec));
  add_targets(comparison, reference, stride);
  if (comparison.cases().count() < 2) reject_clips(comparison);
  add_baselines(comparison, stride, seed);
  for (const ModelGroup& group : group_models(models)) {
    comparison.candidates.push_back(rolled_out(group, comparison, stride, Touch::own));
    if (group.kind != "full") continue;
    Candidate control = rolled_out(group, comparison, stride, Touch::of_other_rollouts);
    control.kind = other_touch_kind;
    control.name = other_touch_kind + group.name.substr(group.kind.size());
    comparison.candidates.push_back(std::move(control));
  }
  return comparison;
}

std::vector<double> coverage_of(const Run& run, const RolloutCases& cases,
                                const std::vector<int>& which, bool scaled) {
  if (!run.model) return {};
  const std::size_t size = cases.path_size(), steps = static_cast<std::size_t>(cases.batch.steps);
  const RolloutBatch batch{static_cast<int>(which.size()),
                           cases.batch.steps,
                           {},
                           {},
                           rows_of(cases.batch.target, which, size),
                           rows_of(cases.batch.weight, which, steps)};
  const Rollout rollout{rows_of(run.rollout.state, which, size),
                        rows_of(run.rollout.spread, which, size)};
  return coverage_by_step(rollout, batch, scaled ? run.model->card.band_scale : BandScale{});
}

}  // namespace touchtrace::study
