#include "pipeline/label/preview/preview.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/videoio.hpp>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "engine/base/scratch_folder.h"

namespace touchtrace::label {
namespace {

namespace fs = std::filesystem;

constexpr int min_size_px = 640, max_size_px = 1920;
constexpr double min_rate_hz = 0.1, max_rate_hz = 1000.0;

bool is_mp4(const fs::path& path) { return path.extension() == ".mp4"; }

/// Rate that every container can store: a multiple of 0.1 Hz.
double video_rate_hz(double rate_hz) {
  return std::clamp(std::round(10.0 * rate_hz) / 10.0, min_rate_hz, max_rate_hz);
}

cv::VideoWriter open_video(const fs::path& file, double rate_hz, cv::Size size) {
  const int codec = is_mp4(file) ? cv::VideoWriter::fourcc('m', 'p', '4', 'v')
                                 : cv::VideoWriter::fourcc('M', 'J', 'P', 'G');
  cv::VideoWriter video(file.string(), codec, video_rate_hz(rate_hz), size);
  if (!video.isOpened())
    throw failure(fmt::format("OpenCV cannot write {} videos of {} x {} pixels",
                              file.extension().string(), size.width, size.height),
                  is_mp4(file) ? "its build may lack FFmpeg; choose a name that ends with .avi"
                               : "check that the disk is not full and the folder is writable");
  return video;
}

void write_frames(const fs::path& file, const LabelOverlay& overlay, const FrameSource& frames,
                  int size_px) {
  Progress progress("writing the preview", overlay.num_frames());
  cv::VideoWriter video;
  for (std::size_t i = 0; i < overlay.num_frames(); ++i) {
    const cv::Mat image = overlay.draw(i, frames.camera_frame(i), size_px);
    if (i == 0) video = open_video(file, overlay.frame_rate_hz(), image.size());
    video.write(image);
    progress.advance();
  }
}

/// OpenCV does not report failed writes.
void require_complete(const fs::path& file, std::size_t num_frames) {
  const cv::VideoCapture video(file.string());
  if (std::lround(video.get(cv::CAP_PROP_FRAME_COUNT)) != static_cast<long>(num_frames))
    throw failure("the preview is incomplete", "check that the disk is not full");
}

}  // namespace

void require_preview_path(const fs::path& path, bool overwrite) {
  if (!is_mp4(path) && path.extension() != ".avi")
    throw usage_error(fmt::format("the name of the preview, '{}', ends with neither .mp4 nor .avi",
                                  path.string()),
                      "choose a name that ends with .mp4");
  const OutputFile file(path, overwrite);
}

void write_preview(const fs::path& path, const Recording& recording, const FrameSource& frames,
                   const RgbdCalibration& calibration, const Labels& labels, bool overwrite) {
  require_preview_path(path, overwrite);
  OutputFile output(path, overwrite);
  // OpenCV chooses the container by the name's ending, which temporary() does not have.
  const ScratchFolder folder;
  const fs::path link = folder.path() / ("preview" + path.extension().string());
  fs::create_symlink(fs::absolute(output.temporary()), link);
  const LabelOverlay overlay(recording, calibration, labels);
  const int longer_side_px = std::max(recording.camera.width, recording.camera.height);
  write_frames(link, overlay, frames, std::clamp(longer_side_px, min_size_px, max_size_px));
  require_complete(link, overlay.num_frames());
  output.commit();
}

}  // namespace touchtrace::label
