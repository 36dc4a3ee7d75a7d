#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {

/// What a stage needs and the recording does not have; empty if the stage can use the recording.
std::vector<std::string> missing_for_calibration(const RecordingReader& reader);
/// `has_calibration`: the user gives a calibration of the cameras.
std::vector<std::string> missing_for_labelling(const RecordingReader& reader, bool has_calibration);
std::vector<std::string> missing_for_training(const Recording& recording);

/// Faults of a clip's boxes, where they are drawn: outside the image, negative sizes, the same box
/// twice, a box_frame outside the clip.
std::vector<std::string> box_faults(const Clip& clip, const Recording& recording);

/// Throws data_error that lists `missing`, if not empty. `name`: of the recording.
void require_usable(const std::vector<std::string>& missing, const std::string& name);

/// Warnings of implausible frames and rates of the gloves. Training with them may not learn from
/// touch.
std::vector<std::string> glove_warnings(const Recording& recording);

/// Result of `touchtrace check`.
struct FileCheck {
  nlohmann::json contents;          ///< activity, clips, streams and their timing
  std::vector<std::string> faults;  ///< damaged images; gloves without usable data
  /// By command ("calibrate", "label", "train"): what it needs and the file does not have.
  std::map<std::string, std::vector<std::string>> missing;
  std::vector<std::string> warnings;  ///< implausible values that no command refuses

  /// True if there are no faults and at least one command can use the file.
  bool is_usable() const;
};

/// Checks a recording or labels file, whichever its schema says. Throws data_error that lists all
/// faults if it cannot be read. `images`: also decompresses every image and compares its checksum.
/// `has_calibration`: as for missing_for_labelling().
FileCheck check_file(const std::filesystem::path& path, bool images, bool has_calibration = false);
FileCheck check_recording(const RecordingReader& reader, bool images, bool has_calibration = false);
FileCheck check_labels(const Labels& labels);

/// {"holds": contents, "faults": [...], "warnings": [...], "lacks": missing, "good": is_usable()}
nlohmann::json to_json(const FileCheck& check);

}  // namespace touchtrace
