#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/board/board_view.h"

namespace touchtrace {

/// Images that the cameras of a rig took at the same time.
struct RigFrame {
  std::string name;                               ///< of the first image, or "frame 3"
  std::vector<std::optional<std::size_t>> views;  ///< [cameras] view; nullopt: no usable view

  std::size_t num_views() const;
};

/// Pairs the views of several cameras by the part of the file name that differs between the images
/// of a camera, without leading zeros: left01.jpg and right01.jpg, 007_color.png and 7_ir.png, or
/// equal time stamps. If fewer than three frames are seen by two cameras that way, and the cameras
/// have equally many images, images are paired in the order of their names. `used`:
/// [cameras][views] false: not paired. Frames without a view are skipped. Throws data_error if a
/// camera has two images of one name.
std::vector<RigFrame> pair_frames(const std::vector<BoardObservations>& cameras,
                                  const std::vector<std::vector<bool>>& used);

}  // namespace touchtrace
