#pragma once

#include <string>

#include "engine/train/model_file.h"
#include "pipeline/dataset/dataset.h"

namespace touchtrace {

/// One step of a roll-out as an ONNX file. Inputs and outputs, with N steps of different sequences
/// (README.md has an example):
///
///   touch [N, M, rows, cols]  pressure 0..1 of the last M frames; unless the model has no touch
///   object [N, embedding]     from object_encoder_onnx(), if the model has an object encoder
///   hidden [N, hidden]        zeros at the start, then next_hidden; only of a GRU
///   state [N, 12]             m and m/s
///   next_state [N, 12]        of the next frame
///   half_width [N, 12]        of the band next_state -/+ half_width, before BandScale [m, m/s]
///   next_hidden [N, hidden]   only of a GRU
std::string step_onnx(const ModelFile& model, const Normalization& scaling);

/// Object encoder as an ONNX file: touch [N, segment_frames, rows, cols] to object [N, embedding].
std::string object_encoder_onnx(const ModelFile& model);

}  // namespace touchtrace
