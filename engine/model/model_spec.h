#pragma once

#include <array>
#include <nlohmann/json.hpp>

#include "engine/ops/activation.h"

namespace touchtrace {

/// Source of the object embedding e_i, an input of the dynamics (section III-C).
enum class ObjectEncoder {
  none,    ///< no object embedding; sufficient for a single object
  frozen,  ///< one constant embedding per object, from an encoder trained beforehand
  joint,   ///< embedding of a segment of each sequence; the encoder is trained jointly
};

/// State transition model: predicts the next state from the current one and the embeddings.
enum class DynamicsKind {
  mlp,  ///< the paper's; no memory
  gru,  ///< carries a hidden state through a roll-out
};

/// Parses "mlp" or "gru".
inline DynamicsKind dynamics_of(std::string_view name) {
  return name == "gru" ? DynamicsKind::gru : DynamicsKind::mlp;
}

/// Architecture of a model. Modules that a spec omits have no kernel and no buffer.
struct ModelSpec {
  bool touch = true;         ///< false: baseline "w/o Touch", without tactile encoder
  int window_frames = 10;    ///< M; the window of step t holds frames t-M+1 .. t (section III-B)
  int rows = 32, cols = 32;  ///< of a tactile frame, 1..64
  int tactile_kernel = 3;    ///< kernel size of both encoders' convolutions, 3 or 5
  std::array<int, 3> tactile_strides{2, 2, 2};  ///< of both encoders' convolutions, 1 or 2 each
  int embedding = 64;  ///< size of g_t and e_i, a multiple of 16 up to 1024
  int hidden = 256;    ///< MLP width or GRU hidden size, a multiple of 64 up to 1024
  int state = 12;      ///< size of s_t, at most 16
  ObjectEncoder object = ObjectEncoder::none;
  int segment_frames = 20;            ///< frames that e_i is computed from, 1..32
  float contrast_temperature = 0.0f;  ///< of normalised embeddings; 0: dot products (equation 5)
  /// Q in (0, 0.5): the band state +- spread lies between the quantiles Q and 1 - Q (equation 3).
  double band_quantile = 0.1;
  DynamicsKind dynamics = DynamicsKind::mlp;
  Activation activation = Activation::relu;  ///< of the dynamics MLP
};

void to_json(nlohmann::json& json, const ModelSpec& spec);
/// Parses and validates; safe for untrusted files. Throws data_error that names key, value and
/// expected range, or nlohmann::json::exception if a key is missing. Keys that older files lack
/// get the default.
void from_json(const nlohmann::json& json, ModelSpec& spec);
/// Throws usage_error that names key, value and expected range.
void validate(const ModelSpec& spec);

}  // namespace touchtrace
