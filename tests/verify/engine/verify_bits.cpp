#include <fmt/core.h>

#include <algorithm>
#include <random>

#include "engine/base/files.h"
#include "engine/base/scratch_folder.h"
#include "engine/train/noise_batch.h"
#include "tests/verify/engine/verify_engine.h"

namespace touchtrace {
namespace {

constexpr int updates = 200;

/// Small, with all modules of the default model.
constexpr ModelSpec small_model{
    .window_frames = 4, .rows = 12, .cols = 12, .embedding = 16, .hidden = 64};

/// A training on random data; all instances are equal.
class Run {
 public:
  explicit Run(Runtime& runtime)
      : trainer_(runtime, small_model, {.updates = updates}, sequences, steps, stream()) {}

  void train_until(int update) {
    while (trainer_.updates() < update) {
      RandomStream random(static_cast<std::uint64_t>(trainer_.updates()), "verify bits, batch");
      trainer_.update(noise_batch(small_model, sequences, steps, frames, random));
    }
  }
  /// Contents of the model file after all updates.
  std::string weights() {
    const ScratchFolder folder;
    train_until(updates);
    trainer_.save(folder.path() / "weights", {}, false);
    return read_file(folder.path() / "weights");
  }
  Trainer& trainer() { return trainer_; }

 private:
  static constexpr int sequences = 3, steps = 4, frames = 60;

  static std::vector<float> stream() {
    RandomStream random(1, "verify bits, stream");
    return noise_stream(small_model, frames, random);
  }

  Trainer trainer_;
};

double differing_bytes(const std::string& a, const std::string& b) {
  double count = std::abs(static_cast<double>(a.size()) - static_cast<double>(b.size()));
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) count += a[i] != b[i];
  return count;
}

/// Weights of a run that is killed after `stop` updates and resumed from its checkpoint.
std::string resumed_weights(Runtime& runtime, int stop) {
  const ScratchFolder folder;
  Run stopped(runtime), resumed(runtime);
  stopped.train_until(stop);
  stopped.trainer().save_checkpoint(folder.path() / "checkpoint");
  resumed.trainer().load_checkpoint(folder.path() / "checkpoint");
  return resumed.weights();
}

}  // namespace

void verify_bits(const std::function<void(Figure)>& emit) {
  Runtime runtime(choose_device(""));
  const auto once = Run(runtime).weights();
  emit(at_most("weights after 200 updates, run twice, that differ",
               differing_bytes(once, Run(runtime).weights()), "bytes", 0.0));
  std::random_device seed;
  for (int turn = 0; turn < 2; ++turn) {
    const int stop = std::uniform_int_distribution(1, updates - 1)(seed);
    emit(at_most(fmt::format("weights after 200 updates, resumed after {}, that differ", stop),
                 differing_bytes(once, resumed_weights(runtime, stop)), "bytes", 0.0));
  }
}

Verification verify_weights() {
  return [](const std::function<void(Figure)>& emit) {
    const ScratchFolder folder;
    Runtime runtime(choose_device(""));
    write_file(folder.path() / "weights", Run(runtime).weights(), false);
    const auto hash = sha256_of_file(folder.path() / "weights").substr(0, 12);
    emit(reported("weights after 200 updates, first 48 bits of SHA-256",
                  static_cast<double>(std::stoull(hash, nullptr, 16)), ""));
  };
}

}  // namespace touchtrace
