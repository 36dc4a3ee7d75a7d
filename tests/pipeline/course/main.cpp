// Writes the batches that `touchtrace train` samples from labelled clips, and its validation
// roll-outs, as a problem of engine_step, so that another implementation can train on the same
// data.
//
//   study_course RECORDING LABELS UPDATES SEED OUT
//
// OUT holds the tensors of tests/engine/step/problem.h and the validation roll-outs,
// "validation.*".
#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/train/safetensors.h"
#include "pipeline/dataset/load.h"
#include "pipeline/study/rollouts.h"
#include "pipeline/study/sampler.h"
#include "pipeline/study/training.h"

using namespace touchtrace;

namespace {

Tensor tensor(std::string name, std::vector<float> values) {
  const std::size_t size = values.size();
  return {std::move(name), {size}, std::move(values)};
}

void add(std::vector<Tensor>& tensors, const std::string& prefix, const RolloutBatch& batch) {
  tensors.push_back(
      tensor(prefix + "first_frame", {batch.first_frame.begin(), batch.first_frame.end()}));
  tensors.push_back(tensor(prefix + "initial_state", batch.initial_state));
  tensors.push_back(tensor(prefix + "target", batch.target));
  tensors.push_back(tensor(prefix + "weight", batch.weight));
}

void append(std::vector<float>& to, const std::vector<float>& values) {
  to.insert(to.end(), values.begin(), values.end());
}

/// All batches of a run, concatenated.
RolloutBatch batches(const study::Sampler& sampler, int count) {
  RolloutBatch all;
  for (int i = 0; i < count; ++i) {
    const auto batch = sampler.batch(i);
    all.first_frame.insert(all.first_frame.end(), batch.first_frame.begin(),
                           batch.first_frame.end());
    append(all.initial_state, batch.initial_state);
    append(all.target, batch.target);
    append(all.weight, batch.weight);
  }
  return all;
}

void write_problem(const std::vector<std::string>& arguments) {
  study::TrainingOptions options;
  options.optimizer.updates = std::stoi(arguments.at(2));
  options.optimizer.seed = std::stoull(arguments.at(3));
  const auto data = load_dataset({{arguments.at(0), arguments.at(1)}}, options.model.resolution);
  const auto scaling = fit_normalization(data);
  const study::Sampler sampler(data, scaling, ModelSpec{.window_frames = options.model.window},
                               options.sequences, options.steps, options.optimizer.seed);
  const auto validation = study::make_cases(data, {Split::validation, 50, 10, options.model.window},
                                            scaling, study::Reference::labels);
  std::vector<Tensor> tensors{tensor("stream", data.tactile)};
  add(tensors, "", batches(sampler, options.optimizer.updates));
  add(tensors, "validation.", validation.batch);
  write_safetensors(
      arguments.at(4),
      {{{"sequences", std::to_string(options.sequences)}, {"steps", std::to_string(options.steps)}},
       std::move(tensors)},
      true);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    write_problem({argv + 1, argv + argc});
    return 0;
  } catch (const Error& error) {
    fmt::print(stderr, "study_course: {}\n{}\n", error.what(), error.hint());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    fmt::print(stderr, "study_course: {}\n", error.what());
    return 1;
  }
}
