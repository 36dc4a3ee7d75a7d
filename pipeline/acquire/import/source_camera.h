#pragma once

#include <filesystem>
#include <string>

#include "pipeline/acquire/import/depth_scale.h"
#include "pipeline/acquire/import/source/source.h"
#include "pipeline/acquire/import/stream_copy.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// What a user states about the camera.
struct CameraOptions {
  std::string camera_info;  ///< file or folder; empty: in the source or its folder
  bool registered = false, no_registered = false;
  double depth_scale = 0.0;     ///< values per metre; 0: the source's
  double depth_offset_s = 0.0;  ///< added to the depth images' times
  std::vector<double> gravity_m_per_s2;
};

struct SourceCamera {
  CameraInfo info;
  ImageFormat color, depth;  ///< depth: without size if the source has none
  DepthScale depth_scale = {};
};

/// Describes the camera of a source at `path`: image sizes, depth unit, intrinsics, registration.
/// Reports what it assumes. Throws data_error for contradictions.
SourceCamera describe_camera(const std::filesystem::path& path, const ImportSource& source,
                             const CameraOptions& options);

}  // namespace touchtrace
