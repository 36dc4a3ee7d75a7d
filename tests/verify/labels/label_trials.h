#pragma once

#include "pipeline/study/label_error.h"
#include "tests/verify/labels/rendered_recording.h"

namespace touchtrace::study {

/// What labels of exact positions at the camera's frames would err by: what 20 frames a second
/// leave to be known, however well a video is seen.
LabelError error_of_exact_positions(const Recording& recording, const Truth& truth);

/// The same of exact positions in the frames that show the object, with white errors of the size
/// that its raw places have: what is above it comes of errors that neighbouring frames share.
LabelError error_of_white_positions(const Recording& recording, const Truth& truth,
                                    const Labels& labels);

/// The picture is covered for a second in the middle of every clip: the most camera frames with the
/// object in the picture that it then takes until it is found again, within 60 mm of the truth; NaN
/// if no clip shows it.
double frames_to_recover(const RenderedRecording& rendered, const std::string& tracker);

/// The object painted like the glove.
scene::ObjectSpec like_the_glove(scene::ObjectSpec object);

}  // namespace touchtrace::study
