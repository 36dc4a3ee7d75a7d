#include "pipeline/export/export.h"
#include "pipeline/export/predictions.h"
#include "pipeline/export/tum_trajectory.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {
namespace {

/// Predicted positions as labels, all of them good.
Labels labels_of(Predictions predictions) {
  Labels labels;
  labels.time_s = std::move(predictions.time_s);
  labels.hand.position_m = std::move(predictions.bodies.at("hand_position_m"));
  labels.object.position_m = std::move(predictions.bodies.at("object_position_m"));
  labels.hand.quality.assign(labels.time_s.size(), quality_good);
  labels.object.quality = labels.hand.quality;
  return labels;
}

}  // namespace

std::vector<std::filesystem::path> write_tum(const ExportRequest& request) {
  const Labels labels = request.kind == FileKind::labels
                            ? read_labels(request.input)
                            : labels_of(read_predictions(request.input));
  const double epoch_unix_s =
      request.recording.empty() ? 0.0 : RecordingReader(request.recording).recording().epoch_unix_s;
  write_tum_trajectories(request.output, labels, epoch_unix_s, request.overwrite);
  const auto files = tum_trajectory_files(request.output);
  return {files.begin(), files.end()};
}

}  // namespace touchtrace
