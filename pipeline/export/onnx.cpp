#include "engine/base/files.h"
#include "pipeline/export/export.h"
#include "pipeline/export/onnx_network.h"
#include "pipeline/study/model_card.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

/// OUT.onnx of the step belongs to OUT.object.onnx of the object encoder.
fs::path object_path(const fs::path& output) {
  auto path = output;
  return path.replace_filename(output.stem().string() + ".object" + output.extension().string());
}

}  // namespace

std::vector<fs::path> write_onnx(const ExportRequest& request) {
  const ModelFile model = read_model_file(request.input);
  const study::ModelCard card = study::read_card(model.metadata, request.input.string());
  const std::string step = step_onnx(model, card.scaling);
  if (model.spec.object == ObjectEncoder::none) {
    write_file(request.output, step, request.overwrite);
    return {request.output};
  }
  const fs::path object = object_path(request.output);
  const std::string encoder = object_encoder_onnx(model);
  { const OutputFile writable(object, request.overwrite); }
  write_file(request.output, step, request.overwrite);
  write_file(object, encoder, request.overwrite);
  return {request.output, object};
}

}  // namespace touchtrace
