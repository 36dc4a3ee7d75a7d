#pragma once

#include <array>
#include <nlohmann/json.hpp>

#include "engine/ops/activation.h"

namespace touchtrace {

/// What tells the dynamics MLP which object is in hand (section III-C).
enum class ObjectEncoder {
  none,    ///< nothing; all there is to do for one object
  frozen,  ///< an embedding e_i of each object, made by an encoder trained before and then fixed
  joint,   ///< the embedding of a segment of each sequence, its encoder trained along
};

/// What predicts the next state from this one and the embeddings.
enum class DynamicsKind {
  mlp,  ///< the paper's, which knows no more than the state and the embeddings
  gru,  ///< remembers a hidden state through a roll-out
};

/// Of "mlp" or "gru".
inline DynamicsKind dynamics_of(std::string_view name) {
  return name == "gru" ? DynamicsKind::gru : DynamicsKind::mlp;
}

/// What the model consists of. Parts that a spec leaves out do not exist: no kernel, no buffer.
struct ModelSpec {
  bool touch = true;         ///< false: the baseline "w/o Touch", no tactile encoder
  int window_frames = 10;    ///< M: the window of step t holds frames t-M+1 .. t (section III-B)
  int rows = 32, cols = 32;  ///< of a tactile frame
  int tactile_kernel = 3;    ///< of the convolutions over tactile frames, in both encoders: 3 or 5
  std::array<int, 3> tactile_strides{2, 2, 2};  ///< of the same, from the first to the last: 1 or 2
  int embedding = 64;  ///< size of the tactile embedding g_t, after LayerNorm; of 16s
  int hidden = 256;    ///< width of the dynamics' hidden layers, or of its memory; of 64s
  int state = 12;      ///< size of s_t, at most 16
  ObjectEncoder object = ObjectEncoder::none;  ///< its embedding e_i has the size of g_t
  int segment_frames = 20;                     ///< of touch that an object is known from
  float contrast_temperature = 0.0f;  ///< of normalised embeddings; 0: dot products (equation 5)
  /// Q: the band state -+ spread lies between the quantiles Q and 1 - Q (equation 3); below a half.
  double band_quantile = 0.1;
  DynamicsKind dynamics = DynamicsKind::mlp;
  Activation activation = Activation::relu;  ///< of the dynamics MLP
};

void to_json(nlohmann::json& json, const ModelSpec& spec);
void from_json(const nlohmann::json& json, ModelSpec& spec);
/// Throws usage_error for sizes that the kernels do not take.
void validate(const ModelSpec& spec);

}  // namespace touchtrace
