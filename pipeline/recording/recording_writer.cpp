#include <fmt/core.h>

#include "engine/base/files.h"
#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/image_series.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/recording/recording_schema.h"

namespace touchtrace {

struct RecordingWriter::File {
  File(const std::filesystem::path& path, const CameraInfo& camera_info, bool overwrite)
      : output(path, overwrite), camera(camera_info) {}

  void create() {
    file = h5::create_file(output.temporary());
    root.emplace(
        h5::Handle(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "cannot open the root group"));
    frames.emplace(root->group("camera"), camera);
    background.emplace(root->group("background"), camera);
    board.emplace(root->group("board"), camera);
  }

  void write_streams(const Recording& recording);
  void close();

  OutputFile output;
  CameraInfo camera;
  h5::Handle file;
  std::optional<h5::Saver> root;
  std::optional<ImageSeriesWriter> frames, background, board;
};

namespace {

void write_root(h5::Saver& root, const Recording& recording) {
  root.attribute("Conventions", std::string("CF-1.10"));
  root.attribute("schema", std::string(recording_schema));
  root.attribute("activity", recording.activity);
  root.attribute("epoch_unix_s", recording.epoch_unix_s);
  root.attribute("provenance", nlohmann::json(recording.provenance));
}

/// Throws failure that lists all arrays whose size does not match.
void require_consistent_sizes(const Recording& recording, std::size_t frames) {
  std::string faults;
  const auto require_size = [&](const std::string& array, std::size_t found, std::size_t expected) {
    if (found != expected)
      faults += fmt::format("\n  {}: expected {} elements, found {}", array, expected, found);
  };
  if (recording.gloves.size() > max_gloves)
    faults += fmt::format("\n  expected at most {} gloves, found {}", max_gloves,
                          recording.gloves.size());
  for (std::size_t i = 0; i < recording.gloves.size(); ++i) {
    const GloveStream& glove = recording.gloves[i];
    const auto taxels = static_cast<std::size_t>(glove.info.taxels());
    const std::string group = "/" + glove_group(i);
    require_size(group + "/host_time_s", glove.host_time_s.size(), glove.frames());
    require_size(group + "/counts", glove.counts.size(), glove.frames() * taxels);
    require_size(group + "/baseline", glove.info.baseline_counts.size(), taxels);
    require_size(group + "/mask", glove.info.mask.size(), taxels);
    require_size(group + "/taxel_position", glove.info.taxel_position_m.size(), 3 * taxels);
  }
  const CameraTimes& times = recording.camera_times;
  require_size("/camera/sequence", times.frames(), frames);
  require_size("/camera/host_time_s", times.host_time_s.size(), frames);
  require_size("/camera/device_time_s", times.device_time_s.size(), frames);
  if (!faults.empty())
    throw failure("sizes of the recording's arrays do not match:" + faults,
                  "give each frame one time stamp, one counter value, its counts and its image");
}

}  // namespace

void RecordingWriter::File::write_streams(const Recording& recording) {
  for (std::size_t i = 0; i < recording.gloves.size(); ++i) {
    h5::Saver glove = root->group(glove_group(i));
    serialize_glove(glove, recording.gloves[i]);
  }
  serialize_camera_info(frames->group(), std::as_const(camera));
  frames->finish(serialize_camera_times(frames->group(), recording.camera_times));
  background->finish();
  serialize_board(board->group(), recording.board);
  board->finish();
}

void RecordingWriter::File::close() {
  frames.reset();
  background.reset();
  board.reset();
  root.reset();
  h5::close_file(file);
  output.commit();
}

RecordingWriter::RecordingWriter(const std::filesystem::path& path, const CameraInfo& camera,
                                 bool overwrite)
    : file_(std::make_unique<File>(path, camera, overwrite)) {
  h5::write_checked(path, [&] { file_->create(); });
}

RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::append_camera_frame(const RgbdFrame& frame) {
  h5::write_checked(file_->output.path(), [&] { file_->frames->append(frame); });
}

void RecordingWriter::append_background(const RgbdFrame& frame) {
  h5::write_checked(file_->output.path(), [&] { file_->background->append(frame); });
}

void RecordingWriter::append_board_view(const RgbdFrame& frame) {
  h5::write_checked(file_->output.path(), [&] { file_->board->append(frame); });
}

void RecordingWriter::write_truth(const Truth& truth) {
  const EventColumns events = to_columns(truth.events);
  h5::write_checked(file_->output.path(), [&] {
    h5::Saver group = file_->root->group("truth");
    serialize_truth(group, truth, events);
  });
}

void RecordingWriter::finish(const Recording& recording) {
  require_consistent_sizes(recording, file_->frames->frames());
  h5::write_checked(file_->output.path(), [&] {
    write_root(*file_->root, recording);
    const ClipColumns clips = to_columns(recording.clips);
    h5::Saver group = file_->root->group("clips");
    serialize_clips(group, clips);
    file_->write_streams(recording);
  });
  h5::write_checked(file_->output.path(), [&] { file_->close(); });
}

}  // namespace touchtrace
