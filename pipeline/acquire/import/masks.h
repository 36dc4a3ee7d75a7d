#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "pipeline/acquire/import/source.h"

namespace touchtrace {

/// Instances that masks number.
struct MaskIds {
  int hand = 1, object = 2;
};

/// Mask files of a folder by the index of their colour image: those with the colour image's file
/// name, or all of them in order if none has. Throws data_error if numbers of files do not match.
std::map<std::size_t, std::filesystem::path> mask_files(const std::filesystem::path& folder,
                                                        const std::vector<SourceImage>& images);

/// MaskValue of each pixel. The image has one channel of instance numbers, or the colours of the
/// palette of PASCAL VOC and DAVIS. Throws std::exception for another size or content.
std::vector<std::uint8_t> read_mask(const std::filesystem::path& file, const MaskIds& ids,
                                    const cv::Size& size);

}  // namespace touchtrace
