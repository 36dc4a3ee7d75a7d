#pragma once

#include <filesystem>

#include "tests/verify/support/figure.h"

// The figures of each area of touchtrace-verify.

namespace touchtrace {

/// Photographs of Debian's opencv-doc, then simulated boards.
Verification calibration_verification();
Verification verify_engine();
/// Loss of one update of the default model: one row, in a process of its own.
Verification verify_first_step();
/// Latency and bits of live predictions, crashes while recording, damaged logs, random bytes for
/// the parsers, and the load of recording.
Verification verify_record();
/// Records 8 hours at 10 times the rates, into memory (/dev/shm) where that is possible, or until
/// Ctrl-C. The rates themselves, on the disk, are those of measure_load().
Verification verify_hours();
/// CPU time and size per frame of a recording, bit flips, killed writers.
Verification verify_recording();

namespace study {
/// Smoothing and clocks on synthetic tracks, and labels of simulated half-minute scenes against
/// their truth. Scenes: ten of activity and object and two of objects held at one end, three seeds
/// each; an occlusion; an object of the glove's colour; every tracker at two image sizes.
Verification verify_labels();
/// Training and evaluation on the synthetic data set, on the fastest device.
Verification verify_study();
}  // namespace study

namespace scene {
/// Closed forms, error over run time, statistics of clips, speed.
Verification verify_scene();
/// Option --real: statistics of the gloves in a folder of recordings, and those of simulated
/// gloves, which should be within the range of the recorded ones.
Verification verify_gloves(const std::filesystem::path& folder);
}  // namespace scene

}  // namespace touchtrace
