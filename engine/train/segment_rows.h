#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/model/model_spec.h"

namespace touchtrace {

/// Throws data_error if a segment that starts at one of `first_frame` is outside a stream of
/// `frames` frames.
void check_segments(const ModelSpec& spec, std::span<const std::int32_t> first_frame,
                    std::size_t frames);

/// Last frames of the segments that start at `first_frame`.
std::vector<std::int32_t> segment_ends(const ModelSpec& spec,
                                       std::span<const std::int32_t> first_frame);

/// Weights for info_nce.h with which the loss is `weight` times the mean over anchors of the mean
/// over an anchor's positives. Anchors have a positive and a negative; others weigh 0.
std::vector<float> contrast_weights(std::span<const std::int32_t> object, double weight);

}  // namespace touchtrace
