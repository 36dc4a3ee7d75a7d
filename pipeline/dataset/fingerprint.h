#pragma once

#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Hashes of a clip's touch, independent of file, boxes and labels: first that of all counts and
/// times, then those of stretches of 10 frames, without their times. One stretch in eight is kept,
/// chosen by its hash (Broder, On the resemblance and containment of documents, 1997, "modulo m"),
/// so that an excerpt keeps the same ones as the whole: of 60 frames it has fewer than two with a
/// probability of 1 %.
std::vector<std::string> clip_fingerprints(const GloveStream& glove, const Clip& clip);

/// Whether `fingerprints` contain the hash of a whole known clip, or two known stretches. `known`:
/// those of all known clips, sorted. Stretches of a glove at rest have no hash.
bool is_known_touch(const std::vector<std::string>& fingerprints,
                    const std::vector<std::string>& known);

}  // namespace touchtrace
