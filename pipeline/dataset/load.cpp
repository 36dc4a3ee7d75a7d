#include "pipeline/dataset/load.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/finite.h"
#include "engine/base/progress.h"
#include "engine/base/provenance.h"
#include "pipeline/dataset/distinct_clips.h"
#include "pipeline/dataset/fingerprint.h"
#include "pipeline/dataset/label_frames.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/recording/check.h"
#include "pipeline/recording/label_check.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

constexpr double max_rate_difference = 0.02;

[[noreturn]] void reject(const LabelledRecording& source, const std::string& fault) {
  throw data_error(fmt::format("{} does not match {}: {}", source.labels.string(),
                               source.recording.string(), fault),
                   "give for each recording the labels that were made of it");
}

State state_of(const std::vector<double>& object_m, const std::vector<double>& object_m_per_s,
               const std::vector<double>& hand_m, const std::vector<double>& hand_m_per_s,
               std::size_t i) {
  State state;
  const std::vector<double>* arrays[] = {&object_m, &object_m_per_s, &hand_m, &hand_m_per_s};
  for (std::size_t d = 0; d < state_size; ++d)
    state[d] = static_cast<float>((*arrays[d / 3])[3 * i + d % 3]);
  return state;
}

std::string kind_of(const Dataset& data) {
  return fmt::format("activity '{}' with {} x {} taxels at {:.4g} Hz", data.activity, data.rows,
                     data.cols, data.rate_hz);
}

/// Adds one recording to a dataset.
class RecordingLoader {
 public:
  RecordingLoader(Dataset& dataset, const LabelledRecording& source, Labels labels, int number,
                  int resolution)
      : dataset_(dataset),
        source_(source),
        number_(number),
        reader_(source.recording),
        labels_(std::move(labels)) {
    check_labels();
    check_compatible(resolution);
    warn();
  }

  void add_clips() {
    const auto& clip = labels_.clip;
    for (auto first = clip.begin(); first != clip.end();) {
      const auto last = std::find_if(first, clip.end(), [&](auto c) { return c != *first; });
      add_clip(*first, static_cast<std::size_t>(first - clip.begin()),
               static_cast<std::size_t>(last - clip.begin()));
      first = last;
    }
  }

 private:
  const GloveStream& glove() const { return reader_.recording().gloves.front(); }

  void check_labels() const;
  void warn();
  void check_compatible(int resolution);
  void add_clip(int clip, std::size_t first, std::size_t last);
  Split split_of(int clip) const;
  void add_image(std::int64_t glove_frame);
  State label(std::size_t i) const {
    return state_of(labels_.object.position_m, labels_.object.velocity_m_per_s,
                    labels_.hand.position_m, labels_.hand.velocity_m_per_s, i);
  }
  State causal_label(std::size_t i) const {
    return state_of(labels_.object.causal_position_m, labels_.object.causal_velocity_m_per_s,
                    labels_.hand.causal_position_m, labels_.hand.causal_velocity_m_per_s, i);
  }

  Dataset& dataset_;
  const LabelledRecording& source_;
  int number_;
  RecordingReader reader_;
  Labels labels_;
  std::optional<AreaAverage> average_;
};

void RecordingLoader::check_labels() const {
  const Recording& recording = reader_.recording();
  require_usable(missing_for_training(recording), source_.recording.string());
  if (labels_.activity != recording.activity)
    reject(source_,
           fmt::format("activity '{}' instead of '{}'", labels_.activity, recording.activity));
  const auto hash = labels_.provenance.input_hash(source_.recording);
  if (!hash.empty() && hash != sha256_of_file(source_.recording))
    reject(source_, "they were made from another file of this name");
  const auto fault = label_frame_fault(labels_, recording);
  if (!fault.empty()) reject(source_, fault);
}

void RecordingLoader::warn() {
  const auto add = [&](const std::filesystem::path& file, const std::string& warning) {
    dataset_.warnings.push_back(fmt::format("{}: {}", file.string(), warning));
    Progress::warn(dataset_.warnings.back());
  };
  for (const auto& warning : glove_warnings(reader_.recording())) add(source_.recording, warning);
  for (const auto& warning : label_warnings(labels_)) add(source_.labels, warning);
  if (const auto warning = missing_labels_warning(labels_, reader_.recording()); !warning.empty())
    add(source_.labels, warning);
}

void RecordingLoader::check_compatible(int resolution) {
  const GloveInfo& info = glove().info;
  Dataset kind;
  kind.activity = labels_.activity;
  const auto [rows, cols] = image_shape(info, resolution);
  kind.rows = rows, kind.cols = cols;
  kind.rate_hz = measured_rate_hz(glove(), reader_.recording().clips);
  if (number_ == 0) dataset_ = kind;
  if (kind.activity != dataset_.activity || kind.rows != dataset_.rows ||
      kind.cols != dataset_.cols ||
      !(std::abs(kind.rate_hz / dataset_.rate_hz - 1.0) <= max_rate_difference))
    throw data_error(fmt::format("{} has {}, the previous recordings have {}",
                                 source_.recording.string(), kind_of(kind), kind_of(dataset_)),
                     "use recordings of one activity and one kind of glove");
  average_.emplace(info.rows, info.cols, dataset_.rows, dataset_.cols);
}

void RecordingLoader::add_image(std::int64_t glove_frame) {
  const auto pixels = static_cast<std::size_t>(dataset_.rows * dataset_.cols);
  auto& tactile = dataset_.tactile;
  tactile.resize(tactile.size() + pixels);
  const auto image = std::span(tactile).last(pixels);
  if (glove_frame < 0) {
    std::copy_n(image.begin() - static_cast<std::ptrdiff_t>(pixels), pixels, image.begin());
    return;
  }
  const GloveInfo& info = glove().info;
  const auto taxels = static_cast<std::size_t>(info.taxels());
  std::vector<float> pressure(taxels);
  counts_to_pressure(
      info,
      std::span(glove().counts).subspan(static_cast<std::size_t>(glove_frame) * taxels, taxels),
      pressure);
  average_->apply(pressure, image);
}

Split RecordingLoader::split_of(int clip) const {
  const auto end = labels_.clips.begin() + clip;
  return split_of_clip(static_cast<int>(std::count_if(
      labels_.clips.begin(), end, [&](const Clip& other) { return other.object == end->object; })));
}

void RecordingLoader::add_clip(int clip, std::size_t first, std::size_t last) {
  const Clip& info = labels_.clips[static_cast<std::size_t>(clip)];
  while (first < last && labels_.glove_frame[first] < 0) ++first;
  if (info.object_fell || first == last) return;
  auto fingerprints =
      touch_fingerprints(glove(), reader_.recording().clips[static_cast<std::size_t>(clip)]);
  std::ranges::copy(motion_fingerprints(labels_, {first, last}), std::back_inserter(fingerprints));
  dataset_.sequences.push_back({dataset_.frames(), static_cast<int>(last - first), info.object,
                                split_of(clip), number_, clip, std::move(fingerprints)});
  for (std::size_t i = first; i < last; ++i) {
    add_image(labels_.glove_frame[i]);
    const bool is_known = all_finite(label(i)) && all_finite(causal_label(i));
    dataset_.label.push_back(is_known ? label(i) : State{});
    dataset_.causal_label.push_back(is_known ? causal_label(i) : State{});
    dataset_.trusted.push_back(is_known && labels_.hand.quality[i] == quality_good &&
                               labels_.object.quality[i] == quality_good);
    dataset_.time_s.push_back(labels_.time_s[i]);
  }
}

void require_clips(const Dataset& dataset) {
  if (dataset.sequences.empty())
    throw data_error("the recordings have no usable labelled clip",
                     "`touchtrace check` shows whether objects fell or tracks were lost");
}

}  // namespace

Split split_of_clip(int clip_of_object) {
  if (clip_of_object % 5 == 1) return Split::evaluation;
  if (clip_of_object % 20 == 3) return Split::validation;
  return clip_of_object % 20 == 8 ? Split::calibration : Split::train;
}

Dataset load_dataset(const std::vector<LabelledRecording>& sources, int resolution) {
  Dataset dataset;
  DistinctClips distinct;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::size_t first = dataset.sequences.size();
    RecordingLoader(dataset, sources[i], read_labels(sources[i].labels), static_cast<int>(i),
                    resolution)
        .add_clips();
    distinct.add(std::span(dataset.sequences).subspan(first), sources[i].recording.string());
  }
  require_clips(dataset);
  return dataset;
}

Dataset load_dataset(const std::filesystem::path& recording, Labels labels, int resolution) {
  Dataset dataset;
  RecordingLoader(dataset, {recording, "labels"}, std::move(labels), 0, resolution).add_clips();
  require_clips(dataset);
  return dataset;
}

}  // namespace touchtrace
