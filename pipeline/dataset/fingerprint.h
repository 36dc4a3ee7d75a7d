#pragma once

#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Hashes of a clip's touch, independent of file, boxes and labels: first that of all counts and
/// times, then those of up to 8 stretches of 10 frames, without their times. The stretches with the
/// smallest hashes are taken (Broder, On the resemblance and containment of documents, 1997), so
/// that a shifted or trimmed copy has most of them.
std::vector<std::string> clip_fingerprints(const GloveStream& glove, const Clip& clip);

/// Whether `fingerprints` contain the hash of a whole known clip, or two known stretches. `known`:
/// those of all known clips, sorted. Stretches of a glove at rest have no hash.
bool is_known_touch(const std::vector<std::string>& fingerprints,
                    const std::vector<std::string>& known);

}  // namespace touchtrace
