// Runs the engine in a separate process, for tests and for comparisons with PyTorch. PROBLEM is a
// safetensors file with weights and batches (problem.h).
//
//   engine_step PROBLEM gradient OUT
//     Writes loss and gradient of the first batch, without dropout.
//   engine_step PROBLEM train N OUT
//     Writes the weights after N updates from the trainer's initial weights.
//   engine_step PROBLEM time [OUT]
//     For each number N read from stdin: N updates, then a line "WALL CPU" of milliseconds per
//     update. Writes the weights to OUT each time.
//   engine_step PROBLEM online
//     For each number N read from stdin: N steps of OnlinePredictor, each from the first initial
//     state; the last one's frame is the first of first_frame. Prints the microseconds of each
//     step, then the last state and spread.
//
// Uses the device named by ENGINE_STEP_DEVICE, as with --device; `online` ignores it.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <iostream>

#include "engine/base/error.h"
#include "engine/train/batch_rows.h"
#include "engine/train/online_predictor.h"
#include "engine/train/weight_file.h"
#include "tests/engine/step/problem.h"

using namespace touchtrace;
using testing::Problem;

namespace {

void write_gradient(Runtime& runtime, const Problem& p, const std::string& out) {
  const auto& batch = p.batches.at(0);
  Model model(runtime, p.spec, batch.sequences, batch.steps, Model::Use::training);
  runtime.write<float>(model.weights().values, values_of(model.table(), p.file));
  write_windows(runtime, model, batch);
  write_initial_states(runtime, model, {batch}, batch.initial_state);
  write_targets(runtime, model, batch);
  write_segments(runtime, model, batch, p.options.object_loss);
  model.prepare();
  model.forward(runtime.upload<float>(p.stream));
  model.backward();
  auto tensors = tensors_of(model.table(), runtime.download(model.weights().gradient));
  tensors.push_back({"loss", {}, runtime.download(model.loss())});
  write_safetensors(out, {{}, std::move(tensors)}, true);
}

/// Training on the problem's batches, cyclically.
class Training {
 public:
  Training(Runtime& runtime, const Problem& p)
      : problem_(p),
        trainer_(runtime, p.spec, p.options, p.batches.at(0).sequences, p.batches.at(0).steps,
                 p.stream) {}

  void run_updates(int updates) {
    for (int i = 0; i < updates; ++i)
      trainer_.update(problem_.batches[std::size_t(trainer_.updates()) % problem_.batches.size()]);
  }
  void save(const std::string& out) const { trainer_.save(out, {}, true); }

 private:
  const Problem& problem_;
  Trainer trainer_;
};

void train(Runtime& runtime, const Problem& p, int updates, const std::string& out) {
  Training training(runtime, p);
  training.run_updates(updates);
  training.save(out);
}

void time_updates(Runtime& runtime, const Problem& p, const std::string& out) {
  Training training(runtime, p);
  for (int updates; std::cin >> updates;) {
    const Stopwatch stopwatch;
    training.run_updates(updates);
    const double wall = stopwatch.wall_seconds(), cpu = stopwatch.cpu_seconds();
    if (!out.empty()) training.save(out);
    std::cout << 1e3 * wall / updates << ' ' << 1e3 * cpu / updates << std::endl;
  }
}

std::span<const float> frame(const Problem& p, int number) {
  const auto size = p.stream.size() / p.frames();
  return std::span(p.stream).subspan(std::size_t(number) * size, size);
}

void time_online(const std::string& path, const Problem& p) {
  Runtime runtime(choose_device_for_small_steps());
  OnlinePredictor predictor(runtime, path);
  const auto initial = std::span(p.batches.at(0).initial_state).first(std::size_t(p.spec.state));
  const int frames = int(p.frames()), last = p.batches.at(0).first_frame.at(0);
  for (int steps; std::cin >> steps;) {
    std::vector<double> microseconds;
    OnlinePredictor::Step result;
    for (int i = 1; i <= steps; ++i) {
      predictor.set_state(initial);
      const auto now = frame(p, (last + steps / frames * frames + frames - steps + i) % frames);
      const Stopwatch stopwatch;
      result = predictor.step(now);
      microseconds.push_back(1e6 * stopwatch.wall_seconds());
    }
    fmt::print("{:.1f}\n{} {}\n", fmt::join(microseconds, " "), fmt::join(result.state, " "),
               fmt::join(result.spread, " "));
    std::fflush(stdout);
  }
}

void run(const std::vector<std::string>& arguments) {
  const auto& path = arguments.at(0);
  const auto problem = testing::read_problem(path);
  const auto& mode = arguments.at(1);
  if (mode == "online") return time_online(path, problem);
  const char* device = std::getenv("ENGINE_STEP_DEVICE");
  Runtime runtime(choose_device(device ? device : ""));
  if (mode == "gradient") write_gradient(runtime, problem, arguments.at(2));
  if (mode == "train") train(runtime, problem, std::stoi(arguments.at(2)), arguments.at(3));
  if (mode == "time")
    time_updates(runtime, problem, arguments.size() > 2 ? arguments[2] : std::string());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run({argv + 1, argv + argc});
    return 0;
  } catch (const Error& error) {
    fmt::print(stderr, "engine_step: {}\n{}\n", error.what(), error.hint());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    fmt::print(stderr, "engine_step: {}\n", error.what());
    return 1;
  }
}
