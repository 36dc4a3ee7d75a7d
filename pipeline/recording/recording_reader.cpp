#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/image_series.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/recording/recording_schema.h"
#include "pipeline/recording/validate.h"

namespace touchtrace {
namespace {

Recording read_streams(const h5::Loader& root) {
  Recording recording;
  root.attribute("activity", recording.activity);
  root.attribute("epoch_unix_s", recording.epoch_unix_s);
  recording.provenance = read_provenance(root);
  recording.clips = read_clips(root);
  for (std::size_t i = 0; i < max_gloves && root.has(glove_group(i)); ++i) {
    const h5::Loader glove = root.group(glove_group(i));
    serialize_glove(glove, recording.gloves.emplace_back());
  }
  const h5::Loader camera = root.group("camera"), board = root.group("board");
  serialize_camera_info(camera, recording.camera);
  serialize_camera_times(camera, recording.camera_times);
  serialize_board(board, recording.board);
  validate(recording, root.faults());
  return recording;
}

}  // namespace

struct RecordingReader::File {
  /// Records faults in `root.faults()`.
  File(const std::filesystem::path& file, const h5::Loader& root)
      : path(file.string()),
        recording(read_streams(root)),
        truth(root.has("truth")),
        frames(root.group("camera"), recording.camera),
        background(root.group("background"), recording.camera),
        board(root.group("board"), recording.camera) {
    const std::size_t expected = recording.camera_times.host_time_s.size();
    if (!root.faults().contains("/camera/host_time_s"))
      root.faults().require(frames.frames() == expected, "/camera/color",
                            fmt::format("expected {} images, one per host_time_s, found {}",
                                        expected, frames.frames()));
  }

  std::string path;
  Recording recording;
  bool truth;
  ImageSeriesReader frames, background, board;
};

RecordingReader::RecordingReader(const std::filesystem::path& path)
    : file_(h5::read_untrusted(path, [&](FileFaults& faults) {
        return std::make_unique<File>(path, h5::open_root(path, recording_schema, faults));
      })) {}

RecordingReader::~RecordingReader() = default;

const Recording& RecordingReader::recording() const { return file_->recording; }

bool RecordingReader::has_depth() const { return file_->frames.has_depth(); }

bool RecordingReader::has_truth() const { return file_->truth; }

RgbdFrame RecordingReader::read_camera_frame(std::size_t index) const {
  return file_->frames.read(index, file_->path);
}

std::size_t RecordingReader::background_frames() const { return file_->background.frames(); }

RgbdFrame RecordingReader::read_background(std::size_t index) const {
  return file_->background.read(index, file_->path);
}

std::size_t RecordingReader::board_views() const { return file_->board.frames(); }

RgbdFrame RecordingReader::read_board_view(std::size_t index) const {
  return file_->board.read(index, file_->path);
}

void RecordingReader::validate(const std::filesystem::path& path) {
  h5::read_untrusted(path, [&](FileFaults& faults) {
    const h5::Loader root = h5::open_root(path, recording_schema, faults);
    const File file(path, root);
    if (root.has("truth")) touchtrace::validate(read_truth_group(root), faults);
    return true;
  });
}

Truth read_truth(const std::filesystem::path& path) {
  return h5::read_untrusted(path, [&](FileFaults& faults) {
    const h5::Loader root = h5::open_root(path, recording_schema, faults);
    if (!root.has("truth"))
      throw data_error(path.string() + ": /truth: missing", "only simulated recordings have it");
    Truth truth = read_truth_group(root);
    validate(truth, faults);
    return truth;
  });
}

bool has_truth(const std::filesystem::path& path) {
  return h5::read_untrusted(path, [&](FileFaults& faults) {
    return h5::open_root(path, recording_schema, faults).has("truth");
  });
}

}  // namespace touchtrace
