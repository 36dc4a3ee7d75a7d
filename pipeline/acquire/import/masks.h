#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "pipeline/acquire/import/source.h"

namespace touchtrace {

/// Instances that masks number.
struct MaskIds {
  int hand = 1, object = 2;
};

/// Mask files of a folder by the index of their colour image: those with the colour image's file
/// name, in which numbers may have other leading zeros, or all of them in order if none has.
/// Reports those that are left out. Throws data_error if numbers of files do not match.
std::map<std::size_t, std::filesystem::path> mask_files(const std::filesystem::path& folder,
                                                        const std::vector<SourceImage>& images);

/// Reads masks: images of one channel with instance numbers, or with the colours of the palette of
/// PASCAL VOC and DAVIS.
class InstanceMaskReader {
 public:
  explicit InstanceMaskReader(const MaskIds& ids) : ids_(ids) {}

  /// MaskValue of each pixel. Throws std::exception for another size or content.
  std::vector<std::uint8_t> read(const std::filesystem::path& file, const cv::Size& size);
  /// After all masks. Throws data_error that names the instances found if none of them is hand or
  /// object, and reports if one of the two is missing.
  void require_ids() const;

 private:
  MaskIds ids_;
  std::set<int> found_;  ///< -1: colours that are not the palette's
};

}  // namespace touchtrace
