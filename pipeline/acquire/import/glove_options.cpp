#include "pipeline/acquire/import/glove_import.h"

namespace touchtrace {

void describe(OptionSet& set, GloveOptions& o) {
  set.group("Glove");
  set.text("glove", o.file,
           "tactile frames: HDF5 of WiReSens or ActionSense, .npz with time_s and counts, or table "
           "with a time and all taxels in each row")
      .value("FILE");
  set.text("glove-stream", o.layout.stream,
           "glove or recording of a file with several, such as tactile-glove-right")
      .value("NAME");
  set.text("taxels", o.layout.taxels,
           "first and last column of the taxels of a table, by name or by number from 1, such as "
           "s_0:s_255 or 3:258; default: all but times, counters and text")
      .value("FIRST:LAST");
  set.integer("rows", o.layout.rows, "rows of taxels of a table; 0: as many as columns", 0, 1024);
  set.integer("cols", o.layout.cols, "columns of taxels of a table; 0: as many as rows", 0, 1024);
  set.integer("bits", o.bits, "of the converter; 0: from the largest count", 0, 16);
  set.integer("polarity", o.polarity,
              "1: counts increase with pressure, -1: they decrease; 0: learnt from the frames", -1,
              1);
  set.number(
         "baseline", o.baseline_counts,
         "value of all taxels without contact, as the file has it; -1: medians of the time at rest",
         -1.0, 65535.0)
      .value("COUNTS");
  set.number("rest-seconds", o.rest_s, "time at the glove's start in which nothing is touched", 0.0,
             1e4)
      .value("SECONDS");
  set.number("glove-offset", o.offset_s,
             "added to the glove's times, which must be on the images' clock", -1e10, 1e10)
      .value("SECONDS");
}

}  // namespace touchtrace
