#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "engine/model/model_spec.h"
#include "engine/ops/tuning.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// How far training is.
struct UpdateCounts {
  int tried = 0;     ///< every random stream and the place in the data are counted by it
  int left_out = 0;  ///< of these, since they were not finite
  int left_out_in_a_row = 0;
};

/// What a checkpoint holds beside its tensors.
struct CheckpointMetadata {
  UpdateCounts counts;
  Tuning tuning;         ///< that it was started with
  nlohmann::json notes;  ///< the caller's
};

std::map<std::string, std::string> to_metadata(const ModelSpec& spec,
                                               const CheckpointMetadata& checkpoint);
/// Throws data_error, naming `path`, if the file is no checkpoint.
CheckpointMetadata checkpoint_metadata(const TensorFile& file, const std::filesystem::path& path);

}  // namespace touchtrace
