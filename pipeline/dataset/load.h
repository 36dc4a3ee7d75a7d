#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/dataset/dataset.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/recording/labels.h"

namespace touchtrace {

/// Recording and the labels that were made from it.
struct LabelledRecording {
  std::filesystem::path recording, labels;
};

/// Loads recordings of one activity with their labels; one sequence per clip.
///
/// - `resolution`: of image_shape(), to which tactile images are averaged by area.
/// - A lost glove frame repeats the previous image; a sequence starts with a received frame.
/// - Skips clips in which the object fell. Labels that are not finite are not trusted.
/// - Warns of implausible frames of the gloves and of implausible labels.
///
/// Throws data_error if a file is invalid, labels belong to another recording, activities, gloves
/// or (by over 2 %) rates differ, recordings have touch or motion in common, or no clip remains;
/// usage_error if `resolution` exceeds the glove's.
Dataset load_dataset(const std::vector<LabelledRecording>& sources,
                     int resolution = own_resolution);
/// Loads one recording with labels that are in memory.
Dataset load_dataset(const std::filesystem::path& recording, Labels labels,
                     int resolution = own_resolution);

/// Split by whole clips, counted from 0 for each object of a recording: 1, 6, 11, ... evaluation
/// (20 %), 3, 23, 43, ... validation (5 %), 8, 28, 48, ... calibration (5 %), others training.
Split split_of_clip(int clip_of_object);

/// Fills `dataset.truth`, for evaluation, from the truth of the recordings that `dataset` was
/// loaded from, in the same order. Interpolation at the label times: cubic Hermite splines for
/// positions, linear for velocities; constant velocity up to 0.1 s beyond a clip's ends. Throws
/// data_error if a recording has no truth there.
void attach_truth(Dataset& dataset, const std::vector<LabelledRecording>& sources);

}  // namespace touchtrace
