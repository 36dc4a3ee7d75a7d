#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/provenance.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// States of one body in the colour camera's frame, row-major. Smoothed states use earlier and
/// later measurements, filtered (causal) states only earlier ones.
struct LabelledBody {
  std::vector<double> position_m;               ///< [n, 3], smoothed
  std::vector<double> velocity_m_per_s;         ///< [n, 3], smoothed
  std::vector<double> covariance;               ///< [n, 6, 6] of (position, velocity), smoothed
  std::vector<double> causal_position_m;        ///< [n, 3], filtered
  std::vector<double> causal_velocity_m_per_s;  ///< [n, 3], filtered
  std::vector<std::uint8_t> quality;            ///< [n], LabelQuality
  /// [n, sources] RMS over the axes of the position's standard deviation by source of error, in the
  /// order of summary["error_sources"]; empty: unknown.
  std::vector<double> error_budget_m;
};

/// Default path of a recording's labels: wave.labels.h5 of wave.h5.
std::filesystem::path labels_path_of(const std::filesystem::path& recording);

/// Bit mask of the reasons why a label is not good.
enum LabelQuality : std::uint8_t {
  quality_good = 0,
  quality_lost = 1,          ///< no measurement nearby: the state is a prediction, or NaN
  quality_follows_hand = 2,  ///< object not distinguished from the hand, moved with it
  quality_gap = 4,           ///< before the first or after the last measurement
};

/// Measurements of each camera frame before smoothing, for the report. NaN where lost.
struct RawTrack {
  std::vector<double> time_s;                        ///< [m], host clock
  std::vector<std::int32_t> clip;                    ///< [m], index of the clip
  std::vector<double> hand_m, object_m;              ///< [m, 3], colour camera's frame
  std::vector<double> hand_sigma_m, object_sigma_m;  ///< [m, 3], standard deviations
};

/// Contents of a labels file: one label per frame of glove 0, lost frames included, ordered by clip
/// and time.
struct Labels {
  std::string activity;
  std::vector<Clip> clips;
  std::vector<double> time_s;             ///< [n], when the glove measured the frame, host clock
  std::vector<std::int32_t> clip;         ///< [n], index of the clip
  std::vector<std::int64_t> glove_frame;  ///< [n], index in GloveStream; -1: frame lost
  LabelledBody hand, object;
  RawTrack raw;
  nlohmann::json summary;  ///< estimated clocks, fraction of lost frames, process noise, events
  Provenance provenance;
  /// JPEG image: some camera frames with the labels drawn into them; empty: none.
  std::vector<std::uint8_t> contact_sheet_jpeg = {};
};

/// Writes a labels file. Throws data_error that lists the faults of invalid labels.
void write_labels(const std::filesystem::path& path, const Labels& labels, bool overwrite);
/// Reads and validates a labels file. Throws data_error that lists all its faults.
Labels read_labels(const std::filesystem::path& path);

}  // namespace touchtrace
