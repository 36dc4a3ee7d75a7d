#include "engine/train/batch_rows.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "engine/base/error.h"
#include "engine/train/segment_rows.h"

namespace touchtrace {
namespace {

void check_size(const char* what, std::size_t size, std::size_t expected) {
  if (size != expected)
    throw failure(fmt::format("batch has {} values of '{}'; expected {}", size, what, expected),
                  "report this as a bug");
}

void write_rows(Runtime& runtime, const Buffer<float>& to, std::span<const std::int32_t> row,
                std::span<const float> from, int size) {
  std::vector<float> rows;
  for (const auto i : row) {
    if (i < 0 || (std::size_t(i) + 1) * size > from.size())
      throw failure(fmt::format("unknown embedding {}", i), "report this as a bug");
    std::ranges::copy(from.subspan(std::size_t(i) * size, size), std::back_inserter(rows));
  }
  runtime.write<float>(to, rows);
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
  for (const auto first : batch.first_frame)
    if (first < spec.window_frames - 1 || std::size_t(first) + batch.steps > frames)
      throw data_error(
          fmt::format("roll-out of {} steps from frame {} is outside the tactile stream of {} "
                      "frames",
                      batch.steps, first, frames),
          "use a longer recording or fewer steps");
}

void check_objects(const RolloutBatch& batch, const ModelSpec& spec, std::size_t frames,
                   Model::Use use) {
  if (spec.object == ObjectEncoder::none) return;
  const bool training = use == Model::Use::training;
  if (training) check_size("object", batch.object.size(), std::size_t(batch.sequences));
  if (training && spec.object == ObjectEncoder::frozen) return;
  check_size("segment_frame", batch.segment_frame.size(), std::size_t(batch.sequences));
  check_segments(spec, batch.segment_frame, frames);
}

void write_windows(Runtime& runtime, const Model& model, const RolloutBatch& batch) {
  if (!model.spec().touch) return;
  std::vector<std::int32_t> window_end;
  for (int t = 0; t < batch.steps; ++t)
    for (const auto first : batch.first_frame) window_end.push_back(first + t);
  runtime.write<std::int32_t>(model.input().window_end, window_end);
}

void write_initial_states(Runtime& runtime, const Model& model, const BatchBlock& block,
                          std::span<const float> initial) {
  const int state = model.spec().state;
  std::vector<float> rows(std::size_t(model.sequences()) * state_lanes, 0.0f);
  for (int s = 0; s < model.sequences(); ++s) {
    const int sequence = block.sequence(s);
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
    throw data_error("no label of the batch has a weight", "label the recording again");
  for (float& w : weight) w = static_cast<float>(w / (total * state));
  runtime.write<float>(model.input().target, target);
  runtime.write<float>(model.input().weight, weight);
}

void write_segments(Runtime& runtime, const Model& model, const RolloutBatch& batch,
                    double object_loss) {
  const auto& input = model.input();
  if (input.segment_end.size() == 0) return;
  runtime.write<std::int32_t>(input.segment_end, segment_ends(model.spec(), batch.segment_frame));
  runtime.write<std::int32_t>(input.object, batch.object);
  runtime.write<float>(input.contrast_weight, contrast_weights(batch.object, object_loss));
}

void write_object_embeddings(Runtime& runtime, const Model& model,
                             std::span<const std::int32_t> row, std::span<const float> embedding) {
  write_rows(runtime, model.input().object_embedding, row, embedding, model.spec().embedding);
}

void write_object_embeddings(Runtime& runtime, const Model& model, const BatchBlock& block,
                             const DistinctEmbeddings& of_sequences) {
  std::vector<std::int32_t> row;
  for (int s = 0; s < model.sequences(); ++s) row.push_back(of_sequences.row[block.sequence(s)]);
  write_object_embeddings(runtime, model, row, of_sequences.values);
}

void write_tactile_embeddings(Runtime& runtime, const Model& model, const BatchBlock& block,
                              const DistinctEmbeddings& of_steps) {
  std::vector<std::int32_t> row;
  for (int t = 0; t < model.steps(); ++t)
    for (int s = 0; s < model.sequences(); ++s)
      row.push_back(
          of_steps.row[std::size_t(block.sequence(s)) * block.batch.steps + block.step(t)]);
  write_rows(runtime, model.input().tactile_embedding, row, of_steps.values,
             model.spec().embedding);
}

}  // namespace touchtrace
