#include <fmt/core.h>

#include "engine/base/files.h"
#include "pipeline/recording/camera_schema.h"
#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/mask_file.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/recording/recording_schema.h"

namespace touchtrace {
namespace {

void write_root(h5::Saver& root, const Recording& recording) {
  root.attribute("Conventions", std::string("CF-1.10"));
  root.attribute("schema", std::string(recording_schema));
  root.attribute("activity", recording.activity);
  root.attribute("epoch_unix_s", recording.epoch_unix_s);
  root.attribute("provenance", nlohmann::json(recording.provenance));
}

/// Stamps of the colour images.
const CameraTimes& color_times(const Recording& recording) {
  return recording.color_times.frames() > 0 ? recording.color_times : recording.camera_times;
}

}  // namespace

struct RecordingWriter::File {
  /// Colour images and, if there are, depth images of one group.
  struct RgbdGroup {
    RgbdGroup(h5::Saver saver, const CameraInfo& camera)
        : group(std::move(saver)),
          color(group, "color", ImageKind::color, camera),
          depth(group, "depth", ImageKind::depth, camera) {}

    void append(const RgbdFrame& frame) {
      color.append(frame.color);
      if (!frame.depth.empty()) depth.append(frame.depth);
    }
    void finish() {
      if (color.frames() == 0) return;
      const h5::Axis frame = group.axis("frame", color.frames());
      color.finish(frame);
      depth.finish(frame, "depth_");
    }

    h5::Saver group;
    ImageWriter color, depth;
  };

  /// Images of one camera with their stamps.
  struct StreamGroup {
    StreamGroup(h5::Saver saver, ImageKind kind, const CameraInfo& camera)
        : group(std::move(saver)), images(group, "image", kind, camera) {}

    void finish(const CameraTimes& times) {
      if (images.frames() > 0) images.finish(serialize_camera_times(group, times));
    }

    h5::Saver group;
    ImageWriter images;
  };

  File(const std::filesystem::path& path, const CameraInfo& camera_info, bool overwrite)
      : output(path, overwrite), camera(camera_info) {}

  void create() {
    file = h5::create_file(output.temporary());
    root.emplace(
        h5::Handle(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, "cannot open the root group"));
    color.emplace(root->group("color"), ImageKind::color, camera);
    depth.emplace(root->group("depth"), ImageKind::depth, camera);
    background.emplace(root->group("background"), camera);
    board.emplace(root->group("board"), camera);
  }

  void append_mask(std::size_t color_image, const std::vector<std::uint8_t>& mask) {
    if (!masks) masks.emplace(root->group("masks"), camera);
    masks->append(color_image, mask);
  }
  void write_camera(const Recording& recording);
  void write_streams(const Recording& recording);
  void close();

  OutputFile output;
  CameraInfo camera;
  h5::Handle file;
  std::optional<h5::Saver> root;
  std::optional<StreamGroup> color, depth;
  std::optional<RgbdGroup> background, board;
  std::optional<MaskWriter> masks;
};

namespace {

/// Throws failure that lists all arrays whose size does not match.
void require_consistent_sizes(const Recording& recording, std::size_t color_images,
                              std::size_t depth_images) {
  std::string faults;
  const auto require_size = [&](const std::string& array, std::size_t found, std::size_t expected) {
    if (found != expected)
      faults += fmt::format("\n  {}: expected {} elements, found {}", array, expected, found);
  };
  const auto require_times = [&](const std::string& group, const CameraTimes& times,
                                 std::size_t images) {
    require_size(group + "/sequence", times.frames(), images);
    require_size(group + "/host_time_s", times.host_time_s.size(), images);
    require_size(group + "/device_time_s", times.device_time_s.size(), images);
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
  if (depth_images > 0) require_times("/depth", recording.camera_times, depth_images);
  if (color_images > 0 || depth_images == 0)
    require_times("/color", color_times(recording), color_images);
  if (!faults.empty())
    throw failure("sizes of the recording's arrays do not match:" + faults,
                  "give each frame one time stamp, one counter value, its counts and its image");
}

}  // namespace

void RecordingWriter::File::write_camera(const Recording& recording) {
  CameraAttributes of_color = color_attributes(camera), of_depth = depth_attributes(camera);
  if (recording.color_times.frames() > 0) of_color.rate_hz.clear();  // the nominal rate is depth's
  serialize_color(color->group, std::as_const(of_color));
  serialize_depth(depth->group, std::as_const(of_depth));
  color->finish(color_times(recording));
  depth->finish(recording.camera_times);
}

void RecordingWriter::File::write_streams(const Recording& recording) {
  for (std::size_t i = 0; i < recording.gloves.size(); ++i) {
    h5::Saver glove = root->group(glove_group(i));
    serialize_glove(glove, recording.gloves[i]);
  }
  write_camera(recording);
  if (masks) masks->finish();
  background->finish();
  serialize_board(board->group, recording.board);
  board->finish();
}

void RecordingWriter::File::close() {
  color.reset(), depth.reset(), background.reset(), board.reset(), masks.reset();
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

void RecordingWriter::append_color(const std::vector<std::uint8_t>& image) {
  h5::write_checked(file_->output.path(), [&] { file_->color->images.append(image); });
}

void RecordingWriter::append_depth(const std::vector<std::uint16_t>& image) {
  h5::write_checked(file_->output.path(), [&] { file_->depth->images.append(image); });
}

void RecordingWriter::append_mask(std::size_t color_frame, const std::vector<std::uint8_t>& mask) {
  h5::write_checked(file_->output.path(), [&] { file_->append_mask(color_frame, mask); });
}

void RecordingWriter::append_camera_frame(const RgbdFrame& frame) {
  if (!frame.mask.empty()) append_mask(file_->color->images.frames(), frame.mask);
  append_color(frame.color);
  if (!frame.depth.empty()) append_depth(frame.depth);
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
  require_consistent_sizes(recording, file_->color->images.frames(), file_->depth->images.frames());
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
