#include <fmt/core.h>

#include <opencv2/imgproc.hpp>

#include "calib/board/board_detector.h"
#include "calib/board/image_matrix.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/recording/camera_schema.h"
#include "pipeline/recording/check.h"

namespace touchtrace {
namespace {

GreyImage grey_of(const RgbdFrame& frame, const CameraInfo& camera) {
  const cv::Mat color(camera.height, camera.width, CV_8UC3,
                      const_cast<std::uint8_t*>(frame.color.data()));
  cv::Mat grey;
  cv::cvtColor(color, grey, cv::COLOR_RGB2GRAY);
  return grey_image(grey);
}

std::vector<float> metres_of(const RgbdFrame& frame, const CameraInfo& camera) {
  std::vector<float> metres;
  metres.reserve(frame.depth.size());
  for (std::uint16_t count : frame.depth)
    metres.push_back(static_cast<float>(count * camera.depth_unit_m));
  return metres;
}

}  // namespace

BoardObservations detect_board_views(const CameraInfo& camera, const BoardInfo& board,
                                     std::size_t count,
                                     const std::function<RgbdFrame(std::size_t)>& read) {
  BoardDetector detector({board.columns, board.rows, board.square_m});
  Progress progress("detecting the board", count);
  for (std::size_t index = 0; index < count; ++index) {
    const RgbdFrame frame = read(index);
    detector.add({.name = fmt::format("view {}", index), .depth_m = metres_of(frame, camera)},
                 grey_of(frame, camera));
    progress.advance();
  }
  BoardObservations observations = std::move(detector).finish();
  observations.depth_intrinsics = depth_intrinsics(camera);
  return observations;
}

BoardObservations board_views_from_recording(const std::filesystem::path& path) {
  const RecordingReader reader(path);
  require_usable(missing_for_calibration(reader), path.string());
  return detect_board_views(reader.recording().camera, reader.recording().board,
                            reader.board_views(),
                            [&](std::size_t index) { return reader.read_board_view(index); });
}

}  // namespace touchtrace
