#pragma once

#include <string>

#include "pipeline/recording/labels.h"

namespace touchtrace {

/// What is wrong with the glove frames of labels of this recording; empty: nothing. In a clip there
/// must be one label per frame of the glove, lost ones included, inside the clip and with the
/// frame's time; both files must have the same clips. Without a glove, only the
/// clips are compared.
std::string label_frame_fault(const Labels& labels, const Recording& recording);

/// Empty, unless over a tenth of the glove's frames in clips to label have no label.
std::string missing_labels_warning(const Labels& labels, const Recording& recording);

}  // namespace touchtrace
