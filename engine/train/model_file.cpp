#include "engine/train/model_file.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/train/weight_file.h"

namespace touchtrace {
namespace {

constexpr const char* model_file_hint = "use a model that touchtrace train wrote";

nlohmann::json parse_metadata(const TensorFile& file, const char* key) {
  const auto found = file.metadata.find(key);
  auto json =
      nlohmann::json::parse(found == file.metadata.end() ? "" : found->second, nullptr, false);
  if (json.is_discarded())
    throw data_error(fmt::format("{}: metadata has no valid '{}'", file.path.string(), key),
                     model_file_hint);
  return json;
}

ModelSpec spec_of(const TensorFile& file) {
  const auto json = parse_metadata(file, "spec");
  try {
    return json.get<ModelSpec>();
  } catch (const nlohmann::json::exception& error) {
    throw data_error(fmt::format("{}: model specification: {}", file.path.string(), error.what()),
                     model_file_hint);
  } catch (const Error& error) {
    throw data_error(fmt::format("{}: {}", file.path.string(), error.what()), error.hint());
  }
}

}  // namespace

std::unique_ptr<Model> ModelFile::make(Runtime& runtime, int sequences, int steps,
                                       Model::Use use) const {
  auto model = std::make_unique<Model>(runtime, spec, sequences, steps, use);
  runtime.write<float>(model->weights().values, values_of(model->table(), file));
  model->prepare();
  return model;
}

ModelFile parse_model_file(TensorFile file) {
  auto spec = spec_of(file);
  auto metadata = parse_metadata(file, "metadata");
  return {std::move(file), spec, std::move(metadata)};
}

ModelFile read_model_file(const std::filesystem::path& path) {
  return parse_model_file(read_safetensors(path));
}

}  // namespace touchtrace
