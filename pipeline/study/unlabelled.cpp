#include "pipeline/study/unlabelled.h"

#include "pipeline/label/states/timeline.h"

namespace touchtrace::study {
namespace {

LabelledBody without_states(std::size_t labels) {
  LabelledBody body;
  for (auto* values : {&body.position_m, &body.velocity_m_per_s, &body.causal_position_m,
                       &body.causal_velocity_m_per_s})
    values->assign(3 * labels, 0.0);
  body.covariance.assign(36 * labels, 0.0);
  body.quality.assign(labels, quality_lost);
  return body;
}

}  // namespace

Labels unlabelled(const Recording& recording) {
  Labels labels;
  labels.activity = recording.activity;
  labels.clips = recording.clips;
  for (const auto& frame : label::label_times(recording, label::align_glove(recording))) {
    labels.time_s.push_back(frame.time_s);
    labels.clip.push_back(frame.clip);
    labels.glove_frame.push_back(frame.glove_frame);
  }
  labels.hand = labels.object = without_states(labels.time_s.size());
  return labels;
}

}  // namespace touchtrace::study
