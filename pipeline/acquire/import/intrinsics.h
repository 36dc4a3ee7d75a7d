#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "calib/camera/camera.h"
#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Reads the intrinsics of one camera: everything read_calibration() reads, a text file with the
/// 3x3 camera matrix or with fx fy cx cy, or JSON with `K`, `intrinsic_matrix` (Open3D: column by
/// column) or fx, fy, cx (ppx), cy (ppy). `width` and `height` [px] are those of the images, which
/// such a file may lack. Throws data_error for an invalid file and for another image size.
RgbdCalibration read_intrinsics(const std::filesystem::path& file, int width, int height);

/// Intrinsics in the folder of the images; nullopt: none.
struct IntrinsicsFiles {
  std::optional<std::filesystem::path> color, depth;
};

/// Finds camera_info, camera_info_color, camera_info_depth, intrinsics, ... (.yaml, .json, .txt) in
/// a folder.
IntrinsicsFiles find_intrinsics(const std::filesystem::path& folder);

}  // namespace touchtrace
