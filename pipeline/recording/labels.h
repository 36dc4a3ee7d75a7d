#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/provenance.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// The states of one body at every label, in the colour camera's frame. Arrays are row-major.
struct LabelledBody {
  std::vector<double> position_m;               ///< [n, 3], smoothed: uses later frames too
  std::vector<double> velocity_m_per_s;         ///< [n, 3], smoothed
  std::vector<double> covariance;               ///< [n, 6, 6] of (position, velocity), smoothed
  std::vector<double> causal_position_m;        ///< [n, 3], filtered: uses no later frame
  std::vector<double> causal_velocity_m_per_s;  ///< [n, 3], filtered
  std::vector<std::uint8_t> quality;            ///< [n], LabelQuality
};

/// 0 is good; bits say why a label is less than that.
enum LabelQuality : std::uint8_t {
  quality_good = 0,
  quality_lost = 1,     ///< nothing was measured nearby: the state is a prediction, or NaN
  quality_follows = 2,  ///< the object was not told from the hand and follows its motion
  quality_gap = 4,      ///< outside the measured time
};

/// What was measured in each camera frame before smoothing, for the report. NaN where lost.
struct RawTrack {
  std::vector<double> time_s;                        ///< [m], host's clock
  std::vector<std::int32_t> clip;                    ///< [m]
  std::vector<double> hand_m, object_m;              ///< [m, 3]
  std::vector<double> hand_sigma_m, object_sigma_m;  ///< [m, 3]
};

/// labels.h5: one label per glove frame of glove0, lost frames included, clip after clip.
struct Labels {
  std::string activity;
  std::vector<Clip> clips;
  std::vector<double> time_s;      ///< [n], aligned: when the glove took the frame, host's clock
  std::vector<std::int32_t> clip;  ///< [n]
  std::vector<std::int64_t>
      glove_frame;  ///< [n], index into the recording's frames; -1: frame lost
  LabelledBody hand, object;
  RawTrack raw;
  nlohmann::json summary;  ///< clocks found, share of lost frames, process noise, events
  Provenance provenance;
};

void write_labels(const std::filesystem::path& path, const Labels& labels, bool overwrite);
/// Throws data_error on a fault.
Labels read_labels(const std::filesystem::path& path);

}  // namespace touchtrace
