#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "engine/cl/runtime.h"
#include "engine/model/model_spec.h"

namespace touchtrace {

/// A trained model that follows a live glove: one tactile frame in, next state and band out. Steps
/// are bitwise equal to a roll-out of Predictor over the same frames. A step allocates nothing and
/// waits once, for its result. Fastest on choose_device_for_small_steps(). Not thread-safe.
///
/// Arguments are not accessed after a call returns or throws. A call that throws for an invalid
/// argument or a missing object changes nothing. After any other exception call set_state() before
/// the next step.
class OnlinePredictor {
 public:
  OnlinePredictor(Runtime& runtime, const std::filesystem::path& model);
  ~OnlinePredictor();

  const ModelSpec& spec() const;
  const nlohmann::json& metadata() const;  ///< as passed to Trainer::save

  /// Starts a roll-out: sets the state [state], scaled, that the next step starts from, and zeroes
  /// the hidden state of a recurrent dynamics. Initially zero.
  void set_state(std::span<const float> state);
  /// Sets the object in hand from a segment [segment_frames, rows, cols] with it, e.g. the first
  /// frames. Required before the first step of a model with an object encoder. Without one the
  /// segment is empty.
  void set_object(std::span<const float> segment);
  /// Sets the object in hand by its embedding [embedding], instead of set_object().
  void set_object_embedding(std::span<const float> embedding);
  /// Appends a frame [rows, cols] (empty without touch) without predicting, e.g. the first M - 1 of
  /// a stream. Frames before the first one are zero.
  void push(std::span<const float> frame);

  /// Both [state], scaled; valid until the next step.
  struct Step {
    std::span<const float> state, spread;
  };
  /// Appends a frame and predicts the state one frame later, which the next step starts from.
  Step step(std::span<const float> frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace touchtrace
