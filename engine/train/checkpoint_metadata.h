#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/model/model_spec.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// Progress of a training.
struct UpdateCounts {
  int attempted = 0;  ///< all updates; random streams and the position in the data depend on it
  int skipped = 0;    ///< of these, not finite
  int consecutive_skips = 0;  ///< up to the last update
};

/// Contents of a checkpoint except its tensors.
struct CheckpointMetadata {
  ModelSpec spec;
  UpdateCounts counts;
  nlohmann::json notes;  ///< of the caller
};

std::map<std::string, std::string> to_metadata(const CheckpointMetadata& checkpoint);
/// Throws data_error, naming `path`, if the file is not a checkpoint or its values are invalid.
CheckpointMetadata checkpoint_metadata(const TensorFile& file, const std::filesystem::path& path);
/// Throws data_error, naming `path` and the difference, unless a training with `spec` can
/// resume from the checkpoint.
void check_resumable(const CheckpointMetadata& checkpoint, const ModelSpec& spec,
                     const std::filesystem::path& path);
}  // namespace touchtrace
