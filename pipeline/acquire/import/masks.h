#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "pipeline/acquire/import/source/source.h"

namespace touchtrace {

/// Instances that masks number.
struct MaskIds {
  int hand = 1, object = 2;
};

/// Mask of one image: a file with instances, or one for each body, brighter than half of its
/// maximum where the body is.
struct MaskFile {
  std::filesystem::path instances, hand, object;

  const std::filesystem::path& any() const {
    return !instances.empty() ? instances : !hand.empty() ? hand : object;
  }
};

/// Mask files of a folder by the index of their colour image: those with the colour image's file
/// name, in which numbers may have other leading zeros, or all of them in order if none has. A
/// folder with the folders `hand` and `object` has a mask for each body. Reports those that are
/// skipped. Throws data_error if numbers of files do not match.
std::map<std::size_t, MaskFile> mask_files(const std::filesystem::path& folder,
                                           const std::vector<SourceImage>& images);

/// Reads masks: images of one channel with instance numbers, or with the colours of the palette of
/// PASCAL VOC and DAVIS.
class InstanceMaskReader {
 public:
  explicit InstanceMaskReader(const MaskIds& ids) : ids_(ids) {}

  /// MaskValue of each pixel. Throws std::exception for another size or content.
  std::vector<std::uint8_t> read(const MaskFile& mask, const cv::Size& size);
  /// After all masks. Throws data_error that names the instances found if none of them is hand or
  /// object, and reports if one of the two is missing.
  void require_ids() const;

 private:
  cv::Mat read_instances(const std::filesystem::path& file, const cv::Size& size);
  cv::Mat read_bodies(const MaskFile& mask, const cv::Size& size);

  MaskIds ids_;
  std::set<int> found_;  ///< -1: colours that are not the palette's
};

}  // namespace touchtrace
