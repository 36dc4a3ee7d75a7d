#pragma once

#include "pipeline/study/label_error.h"
#include "tests/verify/labels/rendered_recording.h"

namespace touchtrace::study {

/// Error of labels made from exact positions at the camera's frames: what the frame rate costs.
LabelError error_of_exact_positions(const Recording& recording, const Truth& truth);

/// As error_of_exact_positions, for the frames in which `labels` found the object and with white
/// noise of the size of its raw positions' white errors. The excess of the labels' error over this
/// comes from errors that neighbouring frames share.
LabelError error_of_white_positions(const Recording& recording, const Truth& truth,
                                    const Labels& labels);

/// Covers the image for one second in the middle of every clip. Returns the largest number of
/// camera frames with the object in the image until it is found again, within 60 mm of the truth;
/// NaN if no clip shows it.
double frames_to_recover(const RenderedRecording& rendered, const std::string& tracker);

/// The object, painted in the glove's colour.
scene::ObjectSpec with_glove_color(scene::ObjectSpec object);

}  // namespace touchtrace::study
