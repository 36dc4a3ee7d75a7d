#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {

/// What a recording lacks for a stage; empty if it serves.
std::vector<std::string> lacks_for_calibrating(const RecordingReader& reader);
std::vector<std::string> lacks_for_labelling(const RecordingReader& reader);
std::vector<std::string> lacks_for_training(const Recording& recording);

/// Throws data_error if `lacks` names anything; `what` is the file.
void require_nothing_lacking(const std::vector<std::string>& lacks, const std::string& what);

/// What `touchtrace check` finds in a file.
struct FileCheck {
  nlohmann::json holds;  ///< what is in it: activity, clips, streams and how regular they are
  std::vector<std::string> faults;  ///< of what is in it
  /// By verb ("calibrate", "label", "train"): what the file lacks for it.
  std::map<std::string, std::vector<std::string>> lacks;

  /// No fault, and of use to some verb.
  bool good() const;
};

/// A recording or a file of labels, told apart by its schema. Throws data_error if it cannot be
/// read. `images`: decompress every image and hold it against its checksum.
FileCheck check_file(const std::filesystem::path& path, bool images);
FileCheck check_recording(const RecordingReader& reader, bool images);
FileCheck check_labels(const Labels& labels);

nlohmann::json to_json(const FileCheck& check);

}  // namespace touchtrace
