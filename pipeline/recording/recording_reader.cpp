#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/image_series.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/recording/recording_schema.h"
#include "pipeline/recording/validate.h"

namespace touchtrace {
namespace {

Recording read_streams(const h5::Loader& root, const std::string& name) {
  Recording recording;
  root.attribute("activity", recording.activity);
  root.attribute("epoch_unix_s", recording.epoch_unix_s);
  recording.provenance = read_provenance(root);
  recording.clips = read_clips(root);
  for (std::size_t i = 0; i < most_gloves && root.has(glove_group(i)); ++i) {
    const h5::Loader glove = root.group(glove_group(i));
    exchange_glove(glove, recording.gloves.emplace_back());
  }
  const h5::Loader camera = root.group("camera"), board = root.group("board");
  exchange_camera_info(camera, recording.camera);
  exchange_camera_times(camera, recording.camera_times);
  exchange_board(board, recording.board);
  validate(recording, name);
  return recording;
}

}  // namespace

struct RecordingReader::File {
  File(const std::filesystem::path& file, const h5::Loader& root)
      : path(file.string()),
        recording(read_streams(root, path)),
        truth(root.has("truth")),
        frames(root.group("camera"), recording.camera),
        background(root.group("background"), recording.camera),
        board(root.group("board"), recording.camera) {
    if (frames.frames() != recording.camera_times.frames())
      throw h5::H5Error("the camera has another number of images than of time stamps");
  }

  std::string path;
  Recording recording;
  bool truth;
  ImageSeriesReader frames, background, board;
};

RecordingReader::RecordingReader(const std::filesystem::path& path)
    : file_(h5::read_untrusted(path, [&] {
        return std::make_unique<File>(path, h5::open_root(path, recording_schema));
      })) {}

RecordingReader::~RecordingReader() = default;

const Recording& RecordingReader::recording() const { return file_->recording; }

bool RecordingReader::has_depth() const { return file_->frames.has_depth(); }

bool RecordingReader::has_truth() const { return file_->truth; }

RgbdFrame RecordingReader::read_camera_frame(std::size_t index) const {
  return file_->frames.read(index, file_->path + ":/camera");
}

std::size_t RecordingReader::background_frames() const { return file_->background.frames(); }

RgbdFrame RecordingReader::read_background(std::size_t index) const {
  return file_->background.read(index, file_->path + ":/background");
}

std::size_t RecordingReader::board_views() const { return file_->board.frames(); }

RgbdFrame RecordingReader::read_board_view(std::size_t index) const {
  return file_->board.read(index, file_->path + ":/board");
}

Truth read_truth(const std::filesystem::path& path) {
  return h5::read_untrusted(path, [&] {
    const h5::Loader root = h5::open_root(path, recording_schema);
    if (!root.has("truth"))
      throw data_error(path.string() + " holds no truth", "only simulated recordings have one");
    Truth truth;
    EventColumns events;
    const h5::Loader group = root.group("truth");
    exchange_truth(group, truth, events);
    truth.events = events_of(events);
    validate(truth, path.string());
    return truth;
  });
}

bool has_truth(const std::filesystem::path& path) {
  return h5::read_untrusted(path,
                            [&] { return h5::open_root(path, recording_schema).has("truth"); });
}

}  // namespace touchtrace
