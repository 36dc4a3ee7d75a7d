#include "pipeline/study/prediction.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "engine/train/predictor.h"
#include "pipeline/dataset/load.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/study/averaged_images.h"
#include "pipeline/study/model_card.h"
#include "pipeline/study/prediction_row.h"
#include "pipeline/study/rollouts.h"
#include "pipeline/study/unlabelled.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;

/// Roll-out of `steps` steps from frame `start` of a dataset.
struct Segment {
  int start, steps;
  bool from_label;
};

/// Roll-outs that cover a clip from frame `first` on.
std::vector<Segment> segments_of(const Dataset& data, const Sequence& clip, int first,
                                 int restart_steps) {
  const int end = clip.first_frame + clip.frames - 1;
  std::vector<Segment> segments;
  for (int start = first; start < end;) {
    int stop = end;
    if (restart_steps > 0)
      for (stop = std::min(end, start + restart_steps); stop < end && !data.trusted[stop];) ++stop;
    segments.push_back({start, stop - start, data.trusted[start] != 0});
    start = stop;
  }
  return segments;
}

class Prediction {
 public:
  Prediction(Runtime& runtime, const PredictionOptions& options)
      : predictor_(runtime, options.model),
        card_(read_card(predictor_.metadata(), options.model)),
        data_(load(options)),
        has_labels_(!options.labels.empty()) {
    require_rate(card_, options.model, data_.rate_hz, options.recording);
    if (auto images = averaged_images(card_.spec, options.model, data_, options.recording)) {
      data_.tactile = std::move(*images);
      data_.rows = card_.spec.rows, data_.cols = card_.spec.cols;
    }
  }

  void run(int restart_steps, const std::function<void(const json&)>& emit) {
    std::size_t rollouts = 0, from_mean = 0;
    for (const Sequence& clip : data_.sequences) {
      const int first = clip.first_frame + required_history(card_.spec) - 1;
      for (const Segment& segment : segments_of(data_, clip, first, restart_steps)) {
        emit_segment(clip, segment, emit);
        ++rollouts, from_mean += !segment.from_label;
      }
    }
    if (has_labels_ && from_mean > 0)
      Progress::warn(fmt::format(
          "{} of {} roll-outs start from the mean training state: their first label is not good",
          from_mean, rollouts));
    if (rollouts == 0)
      throw data_error(
          fmt::format("no clip has more than {} glove frames", required_history(card_.spec)),
          "record longer clips");
  }

 private:
  static Dataset load(const PredictionOptions& options) {
    if (!options.labels.empty())
      return load_dataset(std::vector<LabelledRecording>{{options.recording, options.labels}});
    return load_dataset(options.recording,
                        unlabelled(RecordingReader(options.recording).recording()));
  }

  Rollout roll_out(const Sequence& clip, const Segment& segment) {
    RolloutBatch batch;
    batch.sequences = 1;
    batch.steps = segment.steps;
    batch.first_frame = {segment.start};
    batch.segment_frame = {clip.first_frame};
    const State start =
        segment.from_label ? card_.scaling.normalize(data_.causal_label[segment.start]) : State{};
    batch.initial_state.assign(start.begin(), start.end());
    return predictor_.predict(batch, data_.tactile);
  }

  void emit_segment(const Sequence& clip, const Segment& segment,
                    const std::function<void(const json&)>& emit) {
    const Rollout rollout = roll_out(clip, segment);
    throw_if_interrupted();
    for (int step = 1; step <= segment.steps; ++step) {
      const std::size_t at = std::size_t(step - 1) * state_size;
      json row = prediction_row(card_, segment.from_label, step,
                                std::span(rollout.state).subspan(at, state_size),
                                std::span(rollout.spread).subspan(at, state_size));
      row["clip"] = clip.clip;
      row["time_s"] = data_.time_s[segment.start + step];
      emit(row);
    }
  }

  Predictor predictor_;
  ModelCard card_;
  Dataset data_;
  bool has_labels_;
};

}  // namespace

void describe(OptionSet& set, PredictionOptions& o) {
  set.path("model", o.model, "model that `train` wrote").value("FILE");
  set.text("recording", o.recording, "recording with a glove").value("FILE");
  set.text("labels", o.labels, "its labels: first states of roll-outs (default: the mean state)")
      .value("FILE");
  set.integer("restart-steps", o.restart_steps,
              "steps after which a roll-out starts again at a label; 0: never", 0, 1'000'000);
  set.text("output", o.output, "JSON lines (default: stdout)").value("FILE");
  set.choice("accuracy", o.accuracy, "exact: denormals, compensated sums, no Winograd",
             {"fast", "exact"});
}

void predict(Runtime& runtime, const PredictionOptions& options,
             const std::function<void(const json&)>& emit) {
  Prediction(runtime, options).run(options.restart_steps, emit);
}

}  // namespace touchtrace::study
