#pragma once

#include <filesystem>

#include "engine/cl/runtime.h"
#include "engine/model/model_spec.h"

namespace touchtrace {

/// Writes a model file with a model card, as `train` does, of a model that was trained for a few
/// updates on noise: to test what uses models without waiting for one. Its band scale has two
/// steps, its mean embedding is not that of its training.
void write_noise_model(Runtime& runtime, const std::filesystem::path& path, const ModelSpec& spec,
                       double rate_hz);

}  // namespace touchtrace
