#include "pipeline/acquire/import/source/source.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "pipeline/acquire/board_views.h"

namespace touchtrace {
namespace {

constexpr std::array<SourceKind, 6> source_kinds{{
    {"TUM RGB-D folder (rgb.txt, depth.txt)", is_tum_folder, open_tum_source},
    {"ROS 1 bag", is_bag, open_bag_source},
    {"ROS 2 bag (folder, .db3, .mcap)", is_ros2_bag, open_ros2_bag},
    {"NumPy archive (.npz with color, depth, time_s)", is_numpy_archive, open_numpy_source},
    {"folder with the image folders rgb and depth", is_image_folder, open_image_folder},
    {"folder of colour and depth images, these with 'depth' in their names or as .mat or .npy",
     is_paired_folder, open_paired_folder},
}};

ImportSource open_kind(const SourceKind& kind, const std::filesystem::path& path,
                       const SourceOptions& options) {
  try {
    return kind.open(path, options);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read {}: {}", path.string(), error.what()),
                     fmt::format("give a complete {}", kind.name));
  }
}

const SourceKind* find_kind(const std::filesystem::path& path) {
  const auto* found = std::ranges::find_if(
      source_kinds, [&](const SourceKind& kind) { return kind.is_kind(path); });
  return found == source_kinds.end() ? nullptr : found;
}

/// Folders and files in a folder that are sources, at most three.
std::vector<std::string> sources_in(const std::filesystem::path& folder) {
  std::vector<std::string> found;
  if (!std::filesystem::is_directory(folder)) return found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) try {
      if (found.size() < 3 && find_kind(entry.path())) found.push_back(entry.path().string());
    } catch (const std::exception&) {
      continue;  // has several folders of images, or cannot be read
    }
  std::ranges::sort(found);
  return found;
}

/// Video in a folder with a folder of depth images.
std::optional<std::filesystem::path> find_video(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder / "depth")) return std::nullopt;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    for (const char* extension : {".mp4", ".mov", ".avi", ".mkv"})
      if (lower_case(entry.path().extension().string()) == extension) return entry.path();
  return std::nullopt;
}

std::string known_kinds() {
  std::vector<std::string> names;
  for (const SourceKind& kind : source_kinds) names.emplace_back(kind.name);
  return "give one of: " + comma_separated(names);
}

}  // namespace

ImportSource open_source(const std::filesystem::path& path, const SourceOptions& options) {
  if (!std::filesystem::exists(path))
    throw data_error(fmt::format("{} does not exist", path.string()), "check the path");
  if (const SourceKind* kind = find_kind(path)) return open_kind(*kind, path, options);
  if (const auto video = find_video(path))
    throw data_error(fmt::format("the colour images of {} are a video, {}, which is not read",
                                 path.string(), video->filename().string()),
                     fmt::format("extract them: mkdir {0}/rgb && ffmpeg -i {1} -vsync passthrough "
                                 "-start_number 0 {0}/rgb/%06d.png; then import with --rate HZ",
                                 path.string(), video->string()));
  const auto inner = sources_in(path);
  throw data_error(fmt::format("{} is not a source of colour and depth images", path.string()),
                   inner.empty() ? known_kinds() : "it contains some: " + comma_separated(inner));
}

}  // namespace touchtrace
