#include <fmt/format.h>

#include "engine/base/files.h"
#include "pipeline/export/export.h"
#include "pipeline/export/message_streams.h"
#include "pipeline/export/predictions.h"
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

/// Lines `t x y z 0 0 0 1` of the measured labels in Unix seconds and metres, colour camera's
/// frame. Labels have no rotation.
std::string tum_trajectory(const Labels& labels, const LabelledBody& body, double epoch_unix_s) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (const std::size_t i : measured_labels(body)) {
    const double* p = &body.position_m[3 * i];
    text += fmt::format("{:.6f} {:.9g} {:.9g} {:.9g} 0 0 0 1\n", epoch_unix_s + labels.time_s[i],
                        p[0], p[1], p[2]);
  }
  return text;
}

}  // namespace

std::vector<std::filesystem::path> write_tum(const ExportRequest& request) {
  const Labels labels = request.kind == FileKind::labels
                            ? read_labels(request.input)
                            : labels_of(read_predictions(request.input));
  const double epoch_unix_s =
      request.recording.empty() ? 0.0 : RecordingReader(request.recording).recording().epoch_unix_s;
  const auto hand = request.output / "hand.txt", object = request.output / "object.txt";
  write_file(hand, tum_trajectory(labels, labels.hand, epoch_unix_s), request.overwrite);
  write_file(object, tum_trajectory(labels, labels.object, epoch_unix_s), request.overwrite);
  return {hand, object};
}

}  // namespace touchtrace
