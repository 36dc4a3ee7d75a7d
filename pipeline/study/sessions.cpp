#include "pipeline/study/sessions.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/study/label_error.h"
#include "pipeline/study/truth.h"

namespace touchtrace::study {
namespace {

void add_truth(Session& session, const LabelledRecording& source) {
  attach_truth(session.data, {source});
  shift_truth(session.data, estimate_truth_offset(session.data));
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
                                   const std::string& against) {
  std::vector<Session> sessions;
  for (const LabelledRecording& source : sources) {
    Session session{source.recording.filename().string(), load_dataset({source}), {}};
    if (against != "labels" && has_truth(source.recording)) add_truth(session, source);
    sessions.push_back(std::move(session));
  }
  return sessions;
}

}  // namespace touchtrace::study
