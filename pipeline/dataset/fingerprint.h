#pragma once

#include <string>
#include <vector>

#include "pipeline/recording/clip_range.h"
#include "pipeline/recording/labels.h"

namespace touchtrace {

/// Hashes of a clip's touch, independent of file, boxes and labels: first that of all counts and
/// times, then those of stretches of 10 frames, without their times. One stretch in eight is kept,
/// chosen by its hash (Broder, On the resemblance and containment of documents, 1997, "modulo m"),
/// so that an excerpt keeps the same ones as the whole: of 60 frames it has fewer than two with a
/// probability of 1 %.
std::vector<std::string> touch_fingerprints(const GloveStream& glove, const Clip& clip);

/// Hashes of stretches of 10 steps of the motion in a clip's labels [first, last), one in eight. A
/// step is how far hand and object moved and how far they are apart, to 0.1 mm. They recognise a
/// clip whose counts were changed, or whose positions are in another frame.
std::vector<std::string> motion_fingerprints(const Labels& labels, IndexRange of_clip);

/// Whether fingerprints of touch, then of motion, contain the hash of a whole known clip, or two
/// known stretches. `known`: those of all known clips, sorted. Stretches of a glove, or of a hand
/// and an object, at rest have no hash.
bool is_known_clip(const std::vector<std::string>& fingerprints,
                   const std::vector<std::string>& known);

}  // namespace touchtrace
