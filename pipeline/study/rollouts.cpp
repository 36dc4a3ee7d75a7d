#include "pipeline/study/rollouts.h"

#include <algorithm>
#include <cmath>

#include "engine/base/finite.h"

namespace touchtrace::study {
namespace {

double pinball(double tau, double error) { return std::max(tau * error, (tau - 1.0) * error); }

}  // namespace

int required_history(const ModelSpec& spec) {
  return spec.object == ObjectEncoder::none ? spec.window_frames
                                            : std::max(spec.window_frames, spec.segment_frames);
}

std::vector<Start> find_starts(const Dataset& data, const RolloutGrid& grid) {
  std::vector<Start> starts;
  for (int s = 0; s < static_cast<int>(data.sequences.size()); ++s) {
    const Sequence& sequence = data.sequences[s];
    if (sequence.split != grid.split) continue;
    const int last = sequence.first_frame + sequence.frames - 1 - grid.steps;
    for (int frame = sequence.first_frame + grid.history - 1; frame <= last; frame += grid.stride)
      if (data.trusted[frame]) starts.push_back({s, frame});
  }
  return starts;
}

void append_rollout(RolloutBatch& batch, const Dataset& data, const Normalization& scaling,
                    Reference reference, int start) {
  const auto& states = reference == Reference::labels ? data.label : data.truth;
  const State offset = reference == Reference::unshifted_truth ? data.truth_offset : State{};
  const State initial = scaling.normalize(data.causal_label[start]);
  batch.first_frame.push_back(start);
  batch.initial_state.insert(batch.initial_state.end(), initial.begin(), initial.end());
  for (int frame = start + 1; frame <= start + batch.steps; ++frame) {
    State state = states[frame];
    for (int d = 0; d < state_size; ++d) state[d] -= offset[d];
    const State target = scaling.normalize(state);
    batch.target.insert(batch.target.end(), target.begin(), target.end());
    batch.weight.push_back(reference == Reference::labels && !data.trusted[frame] ? 0.0f : 1.0f);
  }
  ++batch.sequences;
}

RolloutCases make_cases(const Dataset& data, const RolloutGrid& grid, const Normalization& scaling,
                        Reference reference) {
  RolloutCases cases;
  cases.batch.steps = grid.steps;
  for (const auto& [sequence, frame] : find_starts(data, grid)) {
    append_rollout(cases.batch, data, scaling, reference, frame);
    cases.batch.segment_frame.push_back(data.sequences[sequence].first_frame);
    cases.sequence.push_back(sequence);
  }
  return cases;
}

bool is_finite(const Rollout& rollout) {
  return all_finite(rollout.state) && all_finite(rollout.spread);
}

double mean_loss(const Rollout& rollout, const RolloutBatch& batch, double band_quantile) {
  double sum = 0.0, total = 0.0;
  for (std::size_t i = 0; i < batch.target.size(); ++i) {
    const double weight = batch.weight.empty() ? 1.0 : batch.weight[i / state_size];
    const double error = static_cast<double>(batch.target[i]) - rollout.state[i];
    const double spread = rollout.spread[i];
    sum += weight * (std::abs(error) + pinball(band_quantile, error + spread) +
                     pinball(1.0 - band_quantile, error - spread));
    total += weight;
  }
  return sum / total;
}

std::vector<float> rescaled(const std::vector<float>& states, const Normalization& from,
                            const Normalization& to) {
  std::vector<float> result(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    const std::size_t d = i % state_size;
    result[i] = (states[i] * from.sigma[d] + from.mean[d] - to.mean[d]) / to.sigma[d];
  }
  return result;
}

Rollout rescaled(const Rollout& rollout, const Normalization& from, const Normalization& to) {
  Rollout result{rescaled(rollout.state, from, to), rollout.spread};
  for (std::size_t i = 0; i < result.spread.size(); ++i)
    result.spread[i] *= from.sigma[i % state_size] / to.sigma[i % state_size];
  return result;
}

}  // namespace touchtrace::study
