#include "pipeline/study/prediction.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/statistics.h"
#include "engine/train/predictor.h"
#include "pipeline/dataset/load.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/study/metrics.h"
#include "pipeline/study/model_card.h"
#include "pipeline/study/rollouts.h"
#include "pipeline/study/unlabelled.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;

struct Body {
  const char* name;
  Dimensions position, velocity;
};
constexpr Body bodies[] = {{"object", object_position, object_velocity},
                           {"hand", hand_position, hand_velocity}};

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

json values(const State& state, Dimensions dimensions) {
  return std::vector<float>(&state[dimensions.first], &state[dimensions.first] + dimensions.count);
}

void add_state(json& body, const char* name, const State& centre, const State& spread,
               Dimensions dimensions) {
  State low = centre, high = centre;
  for (int d = 0; d < state_size; ++d) low[d] -= spread[d], high[d] += spread[d];
  body[name] = values(centre, dimensions);
  body[std::string(name) + "_low"] = values(low, dimensions);
  body[std::string(name) + "_high"] = values(high, dimensions);
}

class Prediction {
 public:
  Prediction(Runtime& runtime, const PredictionOptions& options)
      : predictor_(runtime, options.model),
        card_(read_card(predictor_.metadata(), options.model)),
        prior_spread_(-normal_quantile(card_.spec.band_quantile)),
        data_(load(options)) {
    require_rate(card_, options.model, data_.rate_hz, options.recording);
  }

  void run(int restart_steps, const std::function<void(const json&)>& emit) {
    bool any = false;
    for (const Sequence& clip : data_.sequences) {
      const int first = clip.first_frame + required_history(card_.spec) - 1;
      for (const Segment& segment : segments_of(data_, clip, first, restart_steps)) {
        emit_segment(clip, segment, emit);
        any = true;
      }
    }
    if (!any)
      throw data_error(
          fmt::format("no clip has more than {} glove frames", required_history(card_.spec)),
          "record longer clips");
  }

 private:
  Dataset load(const PredictionOptions& options) const {
    const int resolution = card_.spec.touch ? card_.spec.rows : 0;
    if (!options.labels.empty())
      return load_dataset(std::vector<LabelledRecording>{{options.recording, options.labels}},
                          resolution);
    return load_dataset(options.recording,
                        unlabelled(RecordingReader(options.recording).recording()), resolution);
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
    return with_scaled_band(predictor_.predict(batch, data_.tactile), segment.steps,
                            card_.band_scale);
  }

  void emit_segment(const Sequence& clip, const Segment& segment,
                    const std::function<void(const json&)>& emit) {
    const Rollout rollout = roll_out(clip, segment);
    for (int step = 1; step <= segment.steps; ++step) {
      State state{}, spread{};
      for (int d = 0; d < state_size; ++d) {
        const std::size_t i = std::size_t(step - 1) * state_size + d;
        state[d] = rollout.state[i];
        spread[d] = static_cast<float>(
            std::hypot(rollout.spread[i], segment.from_label ? 0.0 : prior_spread_) *
            card_.scaling.sigma[d]);
      }
      state = card_.scaling.denormalize(state);
      json row{{"clip", clip.clip},
               {"time_s", data_.time_s[segment.start + step]},
               {"step", step},
               {"start", segment.from_label ? "label" : "prior"}};
      for (const Body& body : bodies) {
        add_state(row[body.name], "position_m", state, spread, body.position);
        add_state(row[body.name], "velocity_m_per_s", state, spread, body.velocity);
      }
      emit(row);
    }
  }

  Predictor predictor_;
  ModelCard card_;
  double prior_spread_;  ///< half width of the band of a standard normal distribution
  Dataset data_;
};

}  // namespace

void describe(OptionSet& set, PredictionOptions& o) {
  set.path("model", o.model, "model that `train` wrote").value("FILE");
  set.path("recording", o.recording, "recording with a glove").value("FILE");
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
