#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "calib/camera/camera.h"
#include "calib/rgbd/calibration.h"

namespace touchtrace {

/// Reads the intrinsics of one camera: everything read_calibration() reads, a text file with the
/// 3x3 or 4x4 camera matrix or with fx fy cx cy, or JSON or YAML with `K`, `cam_K`,
/// `intrinsic_matrix` (Open3D: column by column) or fx, fy, cx (ppx), cy (ppy), at the top, as
/// Camera.fx, ... (ORB-SLAM) or in an entry per camera (color: ...) or image (BOP); of OpenCV's
/// stereo_calib the left camera, M1 and D1.
/// `width` and `height` [px] are those of the images, which such a file may lack. Throws data_error
/// for an invalid file and for another image size.
RgbdCalibration read_intrinsics(const std::filesystem::path& file, int width, int height);

/// Intrinsics in the folder of the images; nullopt: none.
struct IntrinsicsFiles {
  std::optional<std::filesystem::path> color, depth;
};

/// Finds camera_info, camera_info_color, camera_info_depth, intrinsics, ... (.yaml, .json, .txt,
/// .csv) in a folder.
IntrinsicsFiles find_intrinsics(const std::filesystem::path& folder);

/// Counts of depth images per metre from `depth_scale` of a JSON file with intrinsics: millimetres
/// per count (BOP: 0.1, 1), metres per count (RealSense: 0.001) or counts per metre, which its size
/// tells. nullopt: not stated.
std::optional<double> stated_counts_per_m(const std::filesystem::path& file);

}  // namespace touchtrace
