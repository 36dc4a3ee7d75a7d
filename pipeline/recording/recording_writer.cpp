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
    root.emplace(h5::Handle(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "the root group"));
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

void require_same_counts(const Recording& recording, std::size_t frames) {
  const bool gloves_fit =
      std::all_of(recording.gloves.begin(), recording.gloves.end(), [](const GloveStream& glove) {
        const auto taxels = static_cast<std::size_t>(glove.info.taxels());
        return glove.host_time_s.size() == glove.frames() &&
               glove.counts.size() == glove.frames() * taxels &&
               glove.info.baseline_counts.size() == taxels && glove.info.mask.size() == taxels &&
               glove.info.taxel_position_m.size() == 3 * taxels;
      });
  const CameraTimes& times = recording.camera_times;
  if (!gloves_fit || recording.gloves.size() > most_gloves || times.frames() != frames ||
      times.host_time_s.size() != frames || times.device_time_s.size() != frames)
    throw failure("the recording's arrays do not fit each other",
                  "give every frame its stamps, its counts and its image");
}

}  // namespace

void RecordingWriter::File::write_streams(const Recording& recording) {
  for (std::size_t i = 0; i < recording.gloves.size(); ++i) {
    h5::Saver glove = root->group(glove_group(i));
    exchange_glove(glove, recording.gloves[i]);
  }
  exchange_camera_info(frames->group(), std::as_const(camera));
  frames->finish(exchange_camera_times(frames->group(), recording.camera_times));
  background->finish();
  exchange_board(board->group(), recording.board);
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
  const EventColumns events = columns_of(truth.events);
  h5::write_checked(file_->output.path(), [&] {
    h5::Saver group = file_->root->group("truth");
    exchange_truth(group, truth, events);
  });
}

void RecordingWriter::finish(const Recording& recording) {
  require_same_counts(recording, file_->frames->frames());
  h5::write_checked(file_->output.path(), [&] {
    write_root(*file_->root, recording);
    const ClipColumns clips = columns_of(recording.clips);
    h5::Saver group = file_->root->group("clips");
    exchange_clips(group, clips);
    file_->write_streams(recording);
  });
  h5::write_checked(file_->output.path(), [&] { file_->close(); });
}

}  // namespace touchtrace
