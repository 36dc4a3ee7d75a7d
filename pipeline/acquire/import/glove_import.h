#pragma once

#include "engine/base/options.h"
#include "pipeline/acquire/import/clip_file.h"
#include "pipeline/acquire/import/gloves/glove_file.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// A glove to import, and what the user states about it.
struct GloveOptions {
  std::string file;  ///< empty: none
  GloveFileOptions layout;
  int bits = 0, polarity = 0;     ///< 0: estimated
  double baseline_counts = -1.0;  ///< of all taxels; negative: from the time at rest
  double rest_s = 2.0;            ///< at the start, in which nothing is touched
  double offset_s = 0.0;          ///< added to the file's times
};

void describe(OptionSet& set, GloveOptions& options);

struct ImportedGlove {
  GloveStream stream;
  double epoch_unix_s;  ///< Unix time of the stream's 0; 0: unknown
};

/// Reads a glove. Times are on the file's clock, with `offset_s` added; the frame counter skips
/// pauses, as that of `record`, and the frames that the file's numbers skip. Bits, polarity and
/// baseline are estimated unless they are given, and reported. Throws data_error for values that
/// value_scale() refuses and if the polarity is not clear.
ImportedGlove import_glove(const GloveOptions& options);

/// A clip for each stretch of at least 2 frames without a pause, as `record` makes them.
std::vector<Clip> clips_between_pauses(const GloveStream& glove, const std::string& object);

/// Moves the glove's times to the recording's clock, whose 0 is `epoch_s` of the files' clocks.
/// Throws data_error if they do not overlap the images' interval. `offset_s`: already added, for
/// the message.
void move_to_clock(GloveStream& glove, const RecordedTime& images, double offset_s);

}  // namespace touchtrace
