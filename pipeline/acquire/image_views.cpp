#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "calib/board/board_detector.h"
#include "calib/board/image_matrix.h"
#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/acquire/board_size.h"
#include "pipeline/acquire/board_views.h"
#include "pipeline/acquire/decode_image.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

constexpr std::array image_extensions{".png",  ".jpg", ".jpeg", ".bmp", ".tif",
                                      ".tiff", ".pgm", ".ppm",  ".webp"};

constexpr std::array video_extensions{".mp4", ".avi", ".mov", ".mkv", ".webm"};

bool is_image(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  std::error_code unreadable;
  return fs::is_regular_file(path, unreadable) &&
         std::ranges::find(image_extensions, extension) != image_extensions.end();
}

std::vector<fs::path> matches(const std::string& pattern) {
  if (std::error_code unreadable; fs::exists(pattern, unreadable)) return {pattern};
  glob_t found{};
  const std::unique_ptr<glob_t, decltype(&globfree)> release(&found, &globfree);
  std::vector<fs::path> paths;
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0)
    paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  return paths;
}

/// What is at a path instead of images, such as "9 files of .heic".
std::string contents_of(const fs::path& path) {
  std::error_code unreadable;
  if (!fs::is_directory(path, unreadable)) return "nothing has this name";
  std::map<std::string, int> count_of;
  for (const auto& entry : fs::directory_iterator(path, unreadable))
    ++count_of[entry.is_directory(unreadable) ? "folders"
               : entry.path().has_extension()
                   ? "files of " + lower_case(entry.path().extension().string())
                   : "files without an extension"];
  std::vector<std::string> counts;
  for (const auto& [kind, count] : count_of) counts.push_back(fmt::format("{} {}", count, kind));
  return counts.empty() ? "it is empty" : fmt::format("it has {}", fmt::join(counts, ", "));
}

/// The image size with most views of the board; images of other sizes are skipped.
BoardObservations largest_group(std::map<std::pair<int, int>, BoardDetector> detectors,
                                std::vector<SkippedImage> skipped) {
  std::map<std::pair<int, int>, BoardObservations> by_size;
  for (auto& [size, detector] : detectors) by_size[size] = std::move(detector).finish();
  const auto largest = std::ranges::max_element(by_size, {}, [](const auto& group) {
    return std::pair(group.second.views.size(), group.second.views_without_board.size());
  });
  BoardObservations result = std::move(largest->second);
  by_size.erase(largest);
  for (const auto& [size, group] : by_size) {
    const auto why = fmt::format("{}x{} pixels instead of {}x{}", size.first, size.second,
                                 result.width, result.height);
    for (const BoardView& view : group.views) skipped.push_back({view.name, why});
    for (const std::string& name : group.views_without_board) skipped.push_back({name, why});
    for (const SkippedImage& image : group.skipped) skipped.push_back({image.name, why});
  }
  std::ranges::move(skipped, std::back_inserter(result.skipped));
  return result;
}

/// Warns if a program that applies the EXIF orientation sees the image turned.
void warn_if_turned(const fs::path& path, const cv::Mat& stored) {
  const cv::Mat shown = decode_image(path, cv::IMREAD_REDUCED_GRAYSCALE_8);
  if (shown.empty() || (shown.cols > shown.rows) == (stored.cols > stored.rows)) return;
  Progress::warn(
      fmt::format("{} is to be shown turned (EXIF orientation), which is not applied: the "
                  "calibration is of the {} x {} pixels as stored; read images with "
                  "IMREAD_IGNORE_ORIENTATION",
                  path.string(), stored.cols, stored.rows));
}

}  // namespace

GreyImage read_grey(const fs::path& path) {
  const cv::Mat pixels = decode_grey_pixels(path);
  if (pixels.empty())
    throw data_error(fmt::format("{} is not a readable image, or cut off", path.string()),
                     "remove it from the folder");
  return grey_image(pixels);
}

void require_same_size(const GreyImage& first, const GreyImage& image, const fs::path& path) {
  if (image.width != first.width || image.height != first.height)
    throw data_error(
        fmt::format("{} has {}x{} pixels, the previous images have {}x{}", path.string(),
                    image.width, image.height, first.width, first.height),
        "give images of one camera and one size");
}

bool may_be_images(const fs::path& path) {
  std::error_code unreadable;
  return fs::is_directory(path, unreadable) || std::ranges::any_of(matches(path), is_image);
}

void require_no_video(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (std::ranges::find(video_extensions, extension) != video_extensions.end())
    throw data_error(
        path.string() + " is a video",
        "write its images into a folder, e.g. two per second: ffmpeg -i VIDEO -vf fps=2 "
        "photos/%04d.png");
}

std::vector<fs::path> images_in_folder(const fs::path& folder) {
  auto images = matches((folder / "*").string());
  std::erase_if(images, [](const fs::path& path) { return !is_image(path); });
  return images;
}

std::vector<fs::path> image_files(const std::vector<std::string>& folders_or_patterns) {
  std::vector<fs::path> files;
  for (const std::string& source : folders_or_patterns) {
    require_no_video(source);
    if (is_tum_folder(source)) {
      if (folders_or_patterns.size() > 1)
        throw usage_error(source + " is a TUM RGB-D folder, which cannot be combined with others",
                          "give it alone, or its images as '" + source + "/rgb/*'");
      return tum_files(source);
    }
    auto found = fs::is_directory(source) ? images_in_folder(source) : matches(source);
    if (found.empty())
      throw data_error(
          fmt::format("no images in '{}': {}", source, contents_of(source)),
          "give a folder, files, or a pattern such as 'photos/left*.jpg'; videos, HEIC "
          "and raw files have to be converted to JPEG or PNG");
    std::ranges::move(found, std::back_inserter(files));
  }
  return files;
}

BoardObservations board_views_from_images(const std::vector<std::string>& folders_or_patterns,
                                          const CalibrationTarget& board) {
  const auto files = image_files(folders_or_patterns);
  std::map<std::pair<int, int>, BoardDetector> by_size;
  std::vector<SkippedImage> unreadable;
  OtherTargetCheck check(board);
  Progress progress("detecting the board", files.size());
  for (const auto& path : files) {
    progress.advance();
    const cv::Mat pixels = decode_grey_pixels(path);
    if (pixels.empty()) {
      unreadable.push_back({path.filename().string(), "not a readable image, or cut off"});
      continue;
    }
    if (by_size.empty()) warn_if_turned(path, pixels);
    BoardDetector& detector = by_size.try_emplace({pixels.cols, pixels.rows}, board).first->second;
    const GreyImage image = grey_image(pixels);
    check.add(image, detector.add({.name = path.filename().string()}, image), path);
  }
  if (by_size.empty()) throw data_error("none of the images can be read", "give photographs");
  BoardObservations observations = largest_group(std::move(by_size), std::move(unreadable));
  check.finish(observations.views.size());
  return observations;
}

}  // namespace touchtrace
