#include "pipeline/study/sessions.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/study/label_error.h"

namespace touchtrace::study {
namespace {

/// Tactile rows that models of the activity need; 0, the glove's own, without such a model.
int resolution_for(const std::string& activity, const std::vector<LoadedModel>& models) {
  for (const LoadedModel& model : models)
    if (model.card.spec.touch && model.card.activity == activity) return model.card.spec.rows;
  return 0;
}

void add_truth(Session& session, const LabelledRecording& source) {
  attach_truth(session.data, {source});
  session.offset = estimate_offset(session.data);
  shift_truth(session.data, session.offset);
  session.label_error =
      compare_labels_with_truth(read_labels(source.labels), read_truth(source.recording));
}

}  // namespace

std::vector<LabelledRecording> pair_files(const std::vector<std::string>& recordings,
                                          const std::vector<std::string>& labels) {
  if (recordings.size() != labels.size())
    throw usage_error(
        fmt::format("{} recordings but {} label files", recordings.size(), labels.size()),
        "give one --labels file per --recording, in the same order");
  std::vector<LabelledRecording> sources;
  for (std::size_t i = 0; i < labels.size(); ++i) sources.push_back({recordings[i], labels[i]});
  return sources;
}

std::vector<Session> load_sessions(const std::vector<LabelledRecording>& sources,
                                   const std::vector<LoadedModel>& models,
                                   const std::string& against) {
  std::vector<Session> sessions;
  for (const LabelledRecording& source : sources) {
    const RecordingReader reader(source.recording);
    Session session;
    session.name = source.recording.filename().string();
    session.data = load_dataset({source}, resolution_for(reader.recording().activity, models));
    if (against != "labels" && has_truth(source.recording)) add_truth(session, source);
    sessions.push_back(std::move(session));
  }
  return sessions;
}

}  // namespace touchtrace::study
