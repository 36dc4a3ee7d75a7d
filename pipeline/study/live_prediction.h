#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/train/online_predictor.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/recording/recording.h"
#include "pipeline/study/model_card.h"

namespace touchtrace::study {

/// Number of lost frames in a row that a roll-out bridges, with the last image: the horizon at
/// which models are evaluated.
inline constexpr std::uint64_t max_bridged_frames = 50;
/// Least pressure of a taxel that touches something, 12 of 255 counts as in the reader of 3D-ViTac
/// (Huang et al. 2024).
inline constexpr float contact_pressure = 12.0f / 255.0f;

/// Glove with all taxels in its mask and, if it has no baseline, one of 0 counts.
GloveInfo with_all_taxels(GloveInfo glove);

/// {"mean", "max", "contact_taxels"} of the pressure [taxels], 0..1.
nlohmann::json touch_summary(std::span<const float> pressure);

/// Follows a glove: one frame in, one row with the next state and its band out. States and bands
/// are bitwise those of predict() on a recording of the same frames.
///
/// A roll-out starts from the prior, the mean training state, when the model's window and object
/// segment are full. A model with an object encoder that knows its mean training embedding starts a
/// roll-out with it as soon as the window is full, and starts again when the segment is. Each lost
/// frame repeats the last image; more than max_bridged_frames in a row start a new clip.
class LivePrediction {
 public:
  /// A row of prediction_row.h with
  ///   "clip": number of the roll-out's clip, from 0; reset() and long gaps start a new one
  ///   "sequence": number of the last frame that the prediction uses
  ///   "time_s": time of the state, one period after that frame
  ///   "received": false for a lost frame
  ///   "embedding": "segment" or "mean"; "none" for a model without object encoder, and
  ///      until the window is full
  ///   "touch": touch_summary() of the frame; null for a lost frame
  /// Until the window is full: "step" 0, "start" "window", "object" and "hand" null.
  using Emit = std::function<void(nlohmann::json row)>;

  /// Reads the model and compiles its kernels. `glove`: with baseline; all taxels are used. `port`:
  /// its name for messages. Throws data_error if glove and model do not match.
  LivePrediction(Runtime& runtime, const std::string& model, const GloveInfo& glove,
                 const std::string& port);

  const ModelCard& card() const { return card_; }
  /// Sets the glove's baseline [taxels] for the frames that follow.
  void set_baseline(std::vector<float> counts);

  /// Predicts from the frame `counts` [rows, cols] and from those that were lost before it.
  /// `sequence` must increase. Throws data_error if the frames' rate is not the model's: if over 10
  /// s of a clip or more they are off by more than 5 % and one second.
  void add(std::uint64_t sequence, double time_s, std::span<const std::uint16_t> counts,
           const Emit& emit);
  /// Starts a new clip with the next frame.
  void reset();

  /// [rows, cols] pressure of the last frame, 0..1.
  std::span<const float> pressure() const { return pressure_; }
  /// Number of lost frames that roll-outs have bridged.
  std::uint64_t bridged_frames() const { return bridged_frames_; }

 private:
  struct Frame {
    std::uint64_t sequence;
    double time_s;
    bool is_received;
  };

  void warm_up();
  void require_rate_of(const Frame& frame) const;
  /// Predicts from the current image.
  void advance(const Frame& frame, const Emit& emit);
  void start_rollout();
  std::span<const float> image() const;

  OnlinePredictor online_;
  ModelCard card_;
  GloveInfo glove_;
  std::string model_, port_;
  AreaAverage average_;
  std::vector<float> pressure_, image_;
  std::vector<float> segment_;         ///< first images of the clip, for the object encoder
  std::optional<Frame> first_, last_;  ///< of the clip
  int clip_ = 0, frames_ = 0;          ///< frames_: of the clip, lost ones included
  int step_ = 0;                       ///< of the roll-out; 0: none
  const char* embedding_ = "none";
  std::uint64_t bridged_frames_ = 0;
};

}  // namespace touchtrace::study
