#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "engine/cl/runtime.h"
#include "engine/model/model_spec.h"

namespace touchtrace {

/// A trained model that follows a glove: a tactile frame in, the next state and its band out.
/// Steps give the same bits as a roll-out of Predictor over the same frames. A step allocates
/// nothing and waits once, for its result. It is quickest on choose_device_for_small_steps().
class OnlinePredictor {
 public:
  OnlinePredictor(Runtime& runtime, const std::filesystem::path& model);
  ~OnlinePredictor();

  const ModelSpec& spec() const;
  const nlohmann::json& metadata() const;  ///< as given to Trainer::save

  /// Begins a roll-out: the state that the next step starts from, scaled: [state]; a dynamics with
  /// a memory forgets. Zeros at first.
  void set_state(std::span<const float> state);
  /// Touch of the object in hand, [segment_frames, rows, cols], such as its first frames; needed
  /// before the first step of a model with an object encoder.
  void set_object(std::span<const float> segment);
  /// Takes in a frame after which no state is asked for, such as the first M - 1 of a stream:
  /// [rows, cols], empty without touch. Frames before the first one count as zeros.
  void push(std::span<const float> frame);

  /// Does what the next step needs of the frames before its own, so that it answers sooner: to be
  /// called while waiting for that frame. Steps give the same bits without.
  void work_ahead();

  /// Both [state], scaled; valid until the next step.
  struct Step {
    std::span<const float> state, spread;
  };
  /// Takes in a frame and predicts the state one frame later, which the next step starts from.
  Step step(std::span<const float> frame);

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

}  // namespace touchtrace
