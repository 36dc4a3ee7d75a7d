#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/model/model_spec.h"

namespace touchtrace {

/// Throws data_error if a segment that begins at one of `first_frame` does not lie in a stream of
/// `frames` frames.
void check_segments(const ModelSpec& spec, std::span<const std::int32_t> first_frame,
                    std::size_t frames);

/// The last frames of the segments that begin at `first_frame`.
std::vector<std::int32_t> segment_last_frames(const ModelSpec& spec,
                                              std::span<const std::int32_t> first_frame);

/// The weights of info_nce.h with which the loss is `weight` times the mean over anchors of the
/// mean over an anchor's positives. An anchor has a positive and a negative; what has not weighs 0.
std::vector<float> contrast_weights(std::span<const std::int32_t> object, double weight);

}  // namespace touchtrace
