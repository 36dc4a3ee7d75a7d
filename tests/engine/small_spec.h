#pragma once

#include "engine/model/model_spec.h"

namespace touchtrace::testing {

/// Specification small enough for plain loops, with odd sizes where they are allowed.
inline ModelSpec small_spec(bool touch) {
  return {.touch = touch,
          .window_frames = 3,
          .rows = 9,
          .cols = 6,
          .embedding = 16,
          .hidden = 64,
          .state = 5};
}

/// `spec` with a GRU instead of the MLP.
inline ModelSpec with_gru(ModelSpec spec) {
  spec.dynamics = DynamicsKind::gru;
  return spec;
}

/// Small specification with an object encoder.
inline ModelSpec small_spec(ObjectEncoder object, float contrast_temperature = 0.0f) {
  auto spec = small_spec(true);
  spec.object = object;
  spec.segment_frames = 4;
  spec.contrast_temperature = contrast_temperature;
  return spec;
}

/// Small specification with a jointly trained object encoder and other convolutions.
inline ModelSpec small_spec(int kernel, const std::array<int, 3>& strides) {
  auto spec = small_spec(ObjectEncoder::joint);
  spec.tactile_kernel = kernel;
  spec.tactile_strides = strides;
  return spec;
}

}  // namespace touchtrace::testing
