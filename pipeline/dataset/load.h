#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/dataset/dataset.h"

namespace touchtrace {

/// A recording and the labels that were made from it.
struct LabelledRecording {
  std::filesystem::path recording, labels;
};

/// Loads recordings of one activity, each with its labels, one sequence a clip.
///
/// - `resolution`: tactile images are averaged to so many rows and columns (exact areas); 0 keeps
///   the glove's own.
/// - A lost glove frame holds the image before it; a clip begins with its first frame that arrived.
/// - Left out: clips in which the object fell, and clips that hold a label which is not a number.
/// - Splits are `split_of_clip`'s.
///
/// Throws data_error if a file is bad, if labels belong to another recording, if activities, rates
/// or gloves differ, or if no clip is left; usage_error for a resolution that the glove does not
/// have.
Dataset load_dataset(const std::vector<LabelledRecording>& sources, int resolution = 0);

/// Whole clips are kept apart, by their number in the recording, so that a recording splits the
/// same way alone and among others: clips 1, 6, 11, ... evaluate, clips 3, 13, 23, ... validate,
/// the rest trains: 70, 10 and 20 %.
Split split_of_clip(int clip);

/// Fills `dataset.truth` for evaluation: what happened at each label's time, from the truth of the
/// recordings that `dataset` was loaded from, in the same order. Positions by cubic Hermite
/// splines, velocities linearly; at constant velocity up to 0.1 s beyond a clip's ends. Throws
/// data_error if a recording has no truth there.
void attach_truth(Dataset& dataset, const std::vector<LabelledRecording>& sources);

}  // namespace touchtrace
