#include <algorithm>

#include "pipeline/recording/frame_pairs.h"
#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/mask_file.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/recording/recording_layout.h"
#include "pipeline/recording/recording_schema.h"
#include "pipeline/recording/validate.h"

namespace touchtrace {
namespace {

const std::vector<std::string> schemas{recording_schema, recording_schema_1};

h5::Loader open_recording(const std::filesystem::path& path, FileFaults& faults) {
  return h5::open_root(path, schemas, faults);
}

std::string schema_of(const h5::Loader& root) {
  std::string schema;
  root.attribute("schema", schema);
  return schema;
}

CameraTimes select(const CameraTimes& times, const std::vector<FramePair>& pairs,
                   std::size_t FramePair::*member) {
  CameraTimes selected;
  for (const auto& pair : pairs) {
    selected.sequence.push_back(times.sequence[pair.*member]);
    selected.device_time_s.push_back(times.device_time_s[pair.*member]);
    selected.host_time_s.push_back(times.host_time_s[pair.*member]);
  }
  return selected;
}

/// Pairs of colour and depth images; all colour images if there is no depth.
std::vector<FramePair> camera_frames(const RecordingStreams& streams) {
  if (streams.depth_times.frames() > 0)
    return pair_frames(streams.color_times.host_time_s, streams.depth_times.host_time_s);
  std::vector<FramePair> pairs(streams.color_times.frames());
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = {i, i};
  return pairs;
}

/// Expected number of images; unknown if the stamps have a fault.
std::size_t stamped_images(const h5::Loader& group, const CameraTimes& times) {
  return group.faults().contains(group.path("host_time_s")) ? h5::unknown_length : times.frames();
}

/// Truth on the clock of RecordingReader.
Truth read_shifted_truth(const h5::Loader& root) {
  Truth truth = read_truth_group(root);
  const double shift_s = clock_shift_s(root);
  for (double& time_s : truth.time_s) time_s -= shift_s;
  for (auto& event : truth.events) event.time_s -= shift_s;
  return truth;
}

/// Replaces indices of colour images by those of the nearest pairs.
void set_box_frames(const std::vector<FramePair>& pairs, std::size_t color_images,
                    std::vector<Clip>& clips, FileFaults& faults) {
  for (auto& clip : clips) {
    if (!clip.box_frame) continue;
    faults.require(*clip.box_frame < color_images, "/clips/box_frame",
                   fmt::format("expected an index of the {} colour images, found {}", color_images,
                               *clip.box_frame));
    const auto next = std::ranges::lower_bound(pairs, *clip.box_frame, {}, &FramePair::color);
    clip.box_frame.reset();
    if (!pairs.empty())
      clip.box_frame = static_cast<std::size_t>(std::min(next, pairs.end() - 1) - pairs.begin());
  }
}

}  // namespace

struct RecordingReader::File {
  /// Records faults in `root.faults()`.
  File(const std::filesystem::path& file, const h5::Loader& root)
      : File(file, root, CameraLayout(root, schema_of(root))) {}
  File(const std::filesystem::path& file, const h5::Loader& root, const CameraLayout& layout)
      : File(file, root, layout, read_streams(root, layout)) {}
  File(const std::filesystem::path& file, const h5::Loader& root, const CameraLayout& layout,
       RecordingStreams streams);

  RgbdFrame read_frame(const ImageReader& colors, const ImageReader& depths,
                       std::size_t index) const;

  std::string path;
  Recording recording;
  bool truth;
  double clock_shift_s;
  ImageReader color, depth, background_color, background_depth, board_color, board_depth;
  MaskReader masks;
  std::vector<FramePair> pairs;
};

RecordingReader::File::File(const std::filesystem::path& file, const h5::Loader& root,
                            const CameraLayout& layout, RecordingStreams streams)
    : path(file.string()),
      recording(std::move(streams.recording)),
      truth(root.has("truth")),
      clock_shift_s(touchtrace::clock_shift_s(root)),
      color(layout.color, layout.color_images, ImageKind::color, recording.camera,
            stamped_images(layout.color, streams.color_times)),
      depth(layout.depth, layout.depth_images, ImageKind::depth, recording.camera,
            stamped_images(layout.depth, streams.depth_times), streams.float_depth_unit_m),
      background_color(layout.background, "color", ImageKind::color, recording.camera),
      background_depth(layout.background, "depth", ImageKind::depth, recording.camera,
                       background_color.frames(), streams.float_depth_unit_m),
      board_color(layout.board, "color", ImageKind::color, recording.camera),
      board_depth(layout.board, "depth", ImageKind::depth, recording.camera, board_color.frames(),
                  streams.float_depth_unit_m),
      masks(root, recording.camera, color.frames()) {
  if (!root.faults().empty()) return;
  pairs = camera_frames(streams);
  const bool has_depth = depth.frames() > 0;
  recording.camera_times = select(has_depth ? streams.depth_times : streams.color_times, pairs,
                                  has_depth ? &FramePair::depth : &FramePair::color);
  set_box_frames(pairs, color.frames(), recording.clips, root.faults());
}

RgbdFrame RecordingReader::File::read_frame(const ImageReader& colors, const ImageReader& depths,
                                            std::size_t index) const {
  RgbdFrame frame{colors.read<std::uint8_t>(index, path), {}};
  if (depths.frames() > 0) frame.depth = depths.read<std::uint16_t>(index, path);
  return frame;
}

RecordingReader::RecordingReader(const std::filesystem::path& path)
    : file_(h5::read_untrusted(path, [&](FileFaults& faults) {
        return std::make_unique<File>(path, open_recording(path, faults));
      })) {}

RecordingReader::~RecordingReader() = default;

const std::string& RecordingReader::path() const { return file_->path; }

const Recording& RecordingReader::recording() const { return file_->recording; }

bool RecordingReader::has_depth() const { return file_->depth.frames() > 0; }

bool RecordingReader::has_truth() const { return file_->truth; }

RgbdFrame RecordingReader::read_camera_frame(std::size_t index) const {
  if (index >= file_->pairs.size())
    throw data_error(fmt::format("{}: camera frame {} requested, found {}", file_->path, index,
                                 file_->pairs.size()),
                     "`touchtrace check` lists the contents");
  const auto [color, depth] = file_->pairs[index];
  RgbdFrame frame{file_->color.read<std::uint8_t>(color, file_->path), {}};
  if (has_depth()) frame.depth = file_->depth.read<std::uint16_t>(depth, file_->path);
  frame.mask = file_->masks.read(color, file_->path);
  return frame;
}

std::size_t RecordingReader::background_frames() const { return file_->background_color.frames(); }

RgbdFrame RecordingReader::read_background(std::size_t index) const {
  return file_->read_frame(file_->background_color, file_->background_depth, index);
}

std::size_t RecordingReader::board_views() const { return file_->board_color.frames(); }

RgbdFrame RecordingReader::read_board_view(std::size_t index) const {
  return file_->read_frame(file_->board_color, file_->board_depth, index);
}

std::size_t RecordingReader::color_images() const { return file_->color.frames(); }

std::size_t RecordingReader::depth_images() const { return file_->depth.frames(); }

double RecordingReader::clock_shift_s() const { return file_->clock_shift_s; }

std::size_t RecordingReader::color_image_of(std::size_t camera_frame) const {
  return file_->pairs.at(camera_frame).color;
}

std::vector<std::size_t> RecordingReader::masked_color_images() const {
  return file_->masks.color_images();
}

std::vector<std::size_t> RecordingReader::masked_camera_frames() const {
  const auto masked = masked_color_images();
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < file_->pairs.size(); ++i)
    if (std::ranges::binary_search(masked, file_->pairs[i].color)) frames.push_back(i);
  return frames;
}

std::vector<std::uint8_t> RecordingReader::read_mask(std::size_t color_image) const {
  return file_->masks.read(color_image, file_->path);
}

void RecordingReader::validate(const std::filesystem::path& path) {
  h5::read_untrusted(path, [&](FileFaults& faults) {
    const h5::Loader root = open_recording(path, faults);
    const File file(path, root);
    if (root.has("truth")) touchtrace::validate(read_shifted_truth(root), faults);
    return true;
  });
}

Truth read_truth(const std::filesystem::path& path) {
  return h5::read_untrusted(path, [&](FileFaults& faults) {
    const h5::Loader root = open_recording(path, faults);
    if (!root.has("truth"))
      throw data_error(path.string() + ": /truth: missing",
                       "use a simulated recording: only those have it");
    Truth truth = read_shifted_truth(root);
    validate(truth, faults);
    return truth;
  });
}

bool has_truth(const std::filesystem::path& path) {
  return h5::read_untrusted(
      path, [&](FileFaults& faults) { return open_recording(path, faults).has("truth"); });
}

}  // namespace touchtrace
