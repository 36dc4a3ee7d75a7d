#include "engine/train/batch_rows.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

void check_size(const char* what, std::size_t size, std::size_t expected) {
  if (size != expected)
    throw failure(fmt::format("a batch has {} values of {} instead of {}", size, what, expected),
                  "report this as a bug");
}

void check_segments(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames) {
  if (spec.object == ObjectEncoder::none) return;
  check_size("segment_frame", batch.segment_frame.size(), std::size_t(batch.sequences));
  if (!batch.target.empty())
    check_size("object", batch.object.size(), std::size_t(batch.sequences));
  for (const auto first : batch.segment_frame)
    if (first < 0 || std::size_t(first) + spec.segment_frames > frames)
      throw data_error(fmt::format("an object's segment of {} frames from frame {} does not lie in "
                                   "the tactile stream of {}",
                                   spec.segment_frames, first, frames),
                       "use a longer recording or shorter segments");
}

/// For each sequence `weight` over the number of its positives and of all sequences that have both
/// a positive and a negative; 0 for the others.
std::vector<float> contrast_weights(std::span<const std::int32_t> object, double weight) {
  const auto same = [&](auto i) { return std::ranges::count(object, i) - 1; };
  const auto counts = [&](auto i) { return same(i) > 0 && same(i) + 1 < std::ssize(object); };
  const auto anchors = std::ranges::count_if(object, counts);
  std::vector<float> weights;
  for (const auto i : object)
    weights.push_back(counts(i) ? static_cast<float>(weight / double(anchors * same(i))) : 0.0f);
  return weights;
}

}  // namespace

void check(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames) {
  const auto sequences = std::size_t(std::max(batch.sequences, 0));
  const auto rows = sequences * std::size_t(std::max(batch.steps, 0));
  check_size("initial_state", batch.initial_state.size(), sequences * spec.state);
  if (!batch.target.empty()) check_size("target", batch.target.size(), rows * spec.state);
  if (!batch.weight.empty()) check_size("weight", batch.weight.size(), rows);
  if (!spec.touch) return;
  check_size("first_frame", batch.first_frame.size(), sequences);
  check_segments(batch, spec, frames);
  for (const auto first : batch.first_frame)
    if (first < spec.window_frames - 1 || std::size_t(first) + batch.steps > frames)
      throw data_error(
          fmt::format("a roll-out of {} steps from frame {} needs tactile frames that the "
                      "stream of {} does not have",
                      batch.steps, first, frames),
          "use a longer recording or fewer steps");
}

void write_windows(Runtime& runtime, const Model& model, const BatchBlock& block,
                   std::size_t frames) {
  if (!model.spec().touch) return;
  std::vector<std::int32_t> last_frame;
  for (int t = 0; t < model.steps(); ++t)
    for (int s = 0; s < model.sequences(); ++s) {
      const int sequence = std::min(block.first_sequence + s, block.batch.sequences - 1);
      last_frame.push_back(std::min(block.batch.first_frame[sequence] + block.first_step + t,
                                    static_cast<int>(frames) - 1));
    }
  runtime.write<std::int32_t>(model.input().last_frame, last_frame);
}

void write_initial_states(Runtime& runtime, const Model& model, const BatchBlock& block,
                          std::span<const float> initial) {
  const int state = model.spec().state;
  std::vector<float> rows(std::size_t(model.sequences()) * state_lanes, 0.0f);
  for (int s = 0; s < model.sequences(); ++s) {
    const int sequence = std::min(block.first_sequence + s, block.batch.sequences - 1);
    std::copy_n(initial.begin() + sequence * state, state, rows.begin() + s * state_lanes);
  }
  runtime.write<float>(model.states(), rows);
}

void write_targets(Runtime& runtime, const Model& model, const RolloutBatch& batch) {
  const int state = model.spec().state, sequences = batch.sequences, steps = batch.steps;
  const auto given = [&](int s, int t) {
    return batch.weight.empty() ? 1.0f : batch.weight[std::size_t(s) * steps + t];
  };
  std::vector<float> target(std::size_t(sequences) * steps * state_lanes, 0.0f), weight;
  for (int t = 0; t < steps; ++t)
    for (int s = 0; s < sequences; ++s) {
      const auto row = weight.size();
      std::copy_n(batch.target.begin() + (std::ptrdiff_t(s) * steps + t) * state, state,
                  target.begin() + row * state_lanes);
      weight.push_back(given(s, t));
    }
  const double total = std::accumulate(weight.begin(), weight.end(), 0.0);
  if (!(total > 0.0))
    throw data_error("a batch holds no label that is to be trusted", "label the recording again");
  for (float& w : weight) w = static_cast<float>(w / (total * state));
  runtime.write<float>(model.input().target, target);
  runtime.write<float>(model.input().weight, weight);
}

void write_segments(Runtime& runtime, const Model& model, const RolloutBatch& batch,
                    double object_loss) {
  if (model.input().segment_last_frame.size() == 0) return;
  std::vector<std::int32_t> last_frame;
  for (const auto first : batch.segment_frame)
    last_frame.push_back(first + model.spec().segment_frames - 1);
  runtime.write<std::int32_t>(model.input().segment_last_frame, last_frame);
  runtime.write<std::int32_t>(model.input().object, batch.object);
  runtime.write<float>(model.input().contrast_weight, contrast_weights(batch.object, object_loss));
}

}  // namespace touchtrace
