#pragma once

#include <nlohmann/json.hpp>

namespace touchtrace {

/// What the model consists of. Parts that a spec leaves out do not exist: no kernel, no buffer.
struct ModelSpec {
  bool touch = true;         ///< false: the baseline "w/o Touch", no tactile encoder
  int window_frames = 10;    ///< M: the window of step t holds frames t-M+1 .. t (section III-B)
  int rows = 32, cols = 32;  ///< of a tactile frame
  int embedding = 64;        ///< size of the tactile embedding g_t, after LayerNorm; of 16s
  int hidden = 256;          ///< width of the two hidden layers of the dynamics MLP; of 64s
  int state = 12;            ///< size of s_t, at most 16
};

void to_json(nlohmann::json& json, const ModelSpec& spec);
void from_json(const nlohmann::json& json, ModelSpec& spec);
/// Throws usage_error for sizes that the kernels do not take.
void validate(const ModelSpec& spec);

}  // namespace touchtrace
