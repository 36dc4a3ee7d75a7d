// One training step for peers and tests that stand outside the process: reads weights and a batch
// from a safetensors file, so that PyTorch can compute the same, and writes gradients or weights as
// another.
//
//   engine_step PROBLEM gradient OUT   loss and gradient of the batch, no taxel blanked
//   engine_step PROBLEM train N OUT    weights after N updates on the batch, from the trainer's own
//   start engine_step PROBLEM time           for each number read from stdin: that many updates,
//   and a line of
//                                      "WALL CPU", milliseconds an update
//
// PROBLEM holds the metadata "spec" (JSON), "sequences", "steps" and the tensors first_frame [S],
// stream [frames, rows, cols], initial_state [S, state], target [S, T, state], and for `gradient`
// the weights.
#include <fmt/core.h>

#include <iostream>

#include "engine/base/error.h"
#include "engine/train/batch_rows.h"
#include "engine/train/weight_file.h"

using namespace touchtrace;

namespace {

struct Problem {
  TensorFile file;
  ModelSpec spec;
  RolloutBatch batch;
  std::vector<float> stream;

  std::size_t frames() const { return stream.size() / (std::size_t(spec.rows) * spec.cols); }
};

std::vector<float> values(const TensorFile& file, const std::string& name) {
  for (const auto& tensor : file.tensors)
    if (tensor.name == name) return tensor.values;
  return {};
}

Problem read_problem(const std::string& path) {
  Problem p{read_safetensors(path), {}, {}, {}};
  p.spec = nlohmann::json::parse(p.file.metadata.at("spec")).get<ModelSpec>();
  p.batch.sequences = std::stoi(p.file.metadata.at("sequences"));
  p.batch.steps = std::stoi(p.file.metadata.at("steps"));
  for (float frame : values(p.file, "first_frame")) p.batch.first_frame.push_back(int(frame));
  p.batch.initial_state = values(p.file, "initial_state");
  p.batch.target = values(p.file, "target");
  p.stream = values(p.file, "stream");
  return p;
}

void write_gradient(Runtime& runtime, const Problem& p, const std::string& out) {
  Model model(runtime, p.spec, p.batch.sequences, p.batch.steps, Model::Use::training);
  runtime.write<float>(model.weights().values, values_of(model.table(), p.file));
  write_windows(runtime, model, {p.batch}, p.frames());
  write_initial_states(runtime, model, {p.batch}, p.batch.initial_state);
  write_targets(runtime, model, p.batch);
  model.prepare();
  model.forward(runtime.upload<float>(p.stream));
  model.backward();
  auto tensors = tensors_of(model.table(), runtime.download(model.weights().gradient));
  tensors.push_back({"loss", {}, runtime.download(model.loss())});
  write_safetensors(out, {{}, std::move(tensors)}, true);
}

Trainer make_trainer(Runtime& runtime, const Problem& p) {
  return Trainer(runtime, p.spec, {}, p.batch.sequences, p.batch.steps, p.stream);
}

void train(Runtime& runtime, const Problem& p, int updates, const std::string& out) {
  auto trainer = make_trainer(runtime, p);
  while (trainer.updates() < updates) trainer.update(p.batch);
  trainer.save(out, {}, true);
}

void time_updates(Runtime& runtime, const Problem& p) {
  auto trainer = make_trainer(runtime, p);
  for (int updates; std::cin >> updates;) {
    const Stopwatch stopwatch;
    for (int i = 0; i < updates; ++i) trainer.update(p.batch);
    std::cout << 1e3 * stopwatch.wall_seconds() / updates << ' '
              << 1e3 * stopwatch.cpu_seconds() / updates << std::endl;
  }
}

int run(const std::vector<std::string>& arguments) {
  const auto problem = read_problem(arguments.at(0));
  Runtime runtime(choose_device(""));
  const auto& mode = arguments.at(1);
  if (mode == "gradient") write_gradient(runtime, problem, arguments.at(2));
  if (mode == "train") train(runtime, problem, std::stoi(arguments.at(2)), arguments.at(3));
  if (mode == "time") time_updates(runtime, problem);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const Error& error) {
    fmt::print(stderr, "engine_step: {}\n{}\n", error.what(), error.remedy());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    fmt::print(stderr, "engine_step: {}\n", error.what());
    return 1;
  }
}
