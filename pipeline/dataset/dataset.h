#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace touchtrace {

/// The state of equation 2: object position [m] and velocity [m/s], then the hand's.
inline constexpr int state_size = 12;
using State = std::array<float, state_size>;

enum class Split { train, validation, evaluation };

/// Consecutive frames of one grasp, all at the glove's period; lost frames hold the last one's
/// image.
struct Sequence {
  int first_frame = 0, frames = 0;  ///< into Dataset's arrays
  std::string object;
  Split split = Split::train;
  int recording = 0, clip = 0;  ///< which recording, and which of its clips
};

/// What training and evaluation see of one or more labelled recordings.
struct Dataset {
  std::string activity;
  int rows = 32, cols = 32;
  double rate_hz = 15.0;
  std::vector<float> tactile;       ///< [frames, rows, cols], pressure in 0..1, baseline removed
  std::vector<State> label;         ///< [frames], smoothed, from the vision pipeline
  std::vector<State> causal_label;  ///< [frames], filtered: what may start a roll-out at test time
  std::vector<std::uint8_t> trusted;  ///< [frames], 0 where the label is a guess
  std::vector<State> truth;           ///< [frames], empty unless loaded for evaluation
  std::vector<double> time_s;         ///< [frames], when the frame was taken, its recording's clock
  std::vector<Sequence> sequences;

  int frames() const { return static_cast<int>(label.size()); }
};

/// Mean and deviation of the training labels, per state dimension.
struct Normalization {
  State mean{}, deviation{};

  State scaled(const State& state) const;
  State unscaled(const State& state) const;
};

/// Over the trusted labels of the training clips; no deviation below `least_deviation`, which
/// stands for a dimension in which nothing moves. Throws data_error if there is no such label.
Normalization fit_normalization(const Dataset& dataset);

/// 1 mm and 1 mm/s: less is noise of the labels.
inline constexpr float least_deviation = 1e-3f;

}  // namespace touchtrace
