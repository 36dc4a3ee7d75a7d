#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera/camera.h"

namespace touchtrace {

/// Image of a source, not decoded yet.
struct SourceImage {
  std::string name;  ///< for messages
  double host_time_s = 0.0, device_time_s = 0.0;
};

/// Images of one camera in order of their host time.
struct SourceStream {
  std::vector<SourceImage> images;
  /// Decodes an image. Colour: CV_8UC3, blue first. Depth: CV_16UC1 counts or CV_32FC1 metres.
  /// Throws std::exception, which says what is wrong, for a damaged image.
  std::function<cv::Mat(std::size_t index)> read;
  std::optional<Camera> camera = std::nullopt;  ///< as the source states it
  /// Increasing numbers in the names of image files; empty: none.
  std::vector<std::uint64_t> frame_numbers = {};
};

/// Host times [s] of a stream's images.
std::vector<double> host_times_s(const SourceStream& stream);

/// Index of the image nearest in time. Requires images.
std::size_t nearest_image(const SourceStream& stream, double time_s);

/// Recording of another program.
struct ImportSource {
  SourceStream color, depth;
  double counts_per_m = 1000.0;                      ///< of 16-bit depth images
  std::optional<bool> is_registered = std::nullopt;  ///< nullopt: the source does not say
};

/// What sources cannot tell from their content.
struct SourceOptions {
  std::string color_topic, depth_topic;  ///< of a bag; empty: by type and name
  double rate_hz = 0.0;                  ///< of images without time stamps; 0: unknown
};

/// Kind of source. To add one, write its file and a row in source.cpp.
struct SourceKind {
  const char* name;
  bool (*is_kind)(const std::filesystem::path& path);
  ImportSource (*open)(const std::filesystem::path& path, const SourceOptions& options);
};

class MessageFile;
/// Images of ROS topics.
ImportSource open_messages(const std::shared_ptr<MessageFile>& bag, const SourceOptions& options);

/// Opens a source; its content tells the kind. Throws data_error.
ImportSource open_source(const std::filesystem::path& path, const SourceOptions& options);

// Each in its own file:
ImportSource open_tum_source(const std::filesystem::path& folder, const SourceOptions& options);
bool is_bag(const std::filesystem::path& file);
ImportSource open_bag_source(const std::filesystem::path& file, const SourceOptions& options);
bool is_ros2_bag(const std::filesystem::path& path);
ImportSource open_ros2_bag(const std::filesystem::path& path, const SourceOptions& options);
bool is_numpy_archive(const std::filesystem::path& file);
ImportSource open_numpy_source(const std::filesystem::path& file, const SourceOptions& options);
bool is_image_folder(const std::filesystem::path& folder);
ImportSource open_image_folder(const std::filesystem::path& folder, const SourceOptions& options);
bool is_paired_folder(const std::filesystem::path& folder);
ImportSource open_paired_folder(const std::filesystem::path& folder, const SourceOptions& options);

}  // namespace touchtrace
