#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace touchtrace {

/// State of equation 2: object position [m], object velocity [m/s], hand position, hand velocity.
inline constexpr int state_size = 12;
using State = std::array<float, state_size>;

/// Use of a clip: gradients (train), choice of the weights (validation), scale of the band
/// (calibration), or results only (evaluation).
enum class Split { train, validation, calibration, evaluation };

/// Consecutive frames of one clip, at the glove's rate. A lost frame repeats the previous image.
struct Sequence {
  int first_frame = 0, frames = 0;  ///< into Dataset's arrays
  std::string object;
  Split split = Split::train;
  int recording = 0, clip = 0;            ///< index of the recording, and of the clip within it
  std::vector<std::string> fingerprints;  ///< of touch and motion (fingerprint.h)
};

/// Training and evaluation data of one or more labelled recordings.
struct Dataset {
  std::string activity;
  int rows = 32, cols = 32;
  double rate_hz = 15.0;              ///< of the first recording's glove, measured
  std::vector<float> tactile;         ///< [frames, rows, cols], pressure 0..1 above the baseline
  std::vector<State> label;           ///< [frames], smoothed; 0 where not finite
  std::vector<State> causal_label;    ///< [frames], filtered: initial states of roll-outs
  std::vector<std::uint8_t> trusted;  ///< [frames], 1: labels are finite and have quality_good
  std::vector<State> truth;           ///< [frames], filled by attach_truth, else empty
  std::vector<double> time_s;         ///< [frames], when the glove measured the frame, host clock
  std::vector<Sequence> sequences;
  State truth_offset{};  ///< already added to `truth`
  std::vector<std::string>
      warnings;  ///< of the recordings' gloves and labels, with the file's name

  int frames() const { return static_cast<int>(label.size()); }
};

/// Mean and standard deviation of the training labels, per state dimension.
struct Normalization {
  State mean{}, sigma{};

  State normalize(const State& state) const;
  State denormalize(const State& state) const;
  /// Root of the summed variances of both bodies' positions.
  double position_spread_m() const;
};

/// Smallest Normalization::sigma, 1 mm and 1 mm/s: a smaller spread is label noise.
inline constexpr float min_sigma = 1e-3f;

/// Mean and standard deviation over the trusted labels of the training clips. Throws data_error if
/// there are none.
Normalization fit_normalization(const Dataset& dataset);

/// The same over the clips of all splits; nullopt if they have no trusted label.
std::optional<Normalization> fit_normalization_of_all_clips(const Dataset& dataset);

}  // namespace touchtrace
