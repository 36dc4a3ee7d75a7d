#include "engine/model/model_spec.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

void require(bool holds, const char* what) {
  if (!holds)
    throw usage_error(fmt::format("a model's {}", what), "correct the model's specification");
}

}  // namespace

NLOHMANN_JSON_SERIALIZE_ENUM(ObjectEncoder, {{ObjectEncoder::none, "none"},
                                             {ObjectEncoder::frozen, "frozen"},
                                             {ObjectEncoder::joint, "joint"}})

NLOHMANN_JSON_SERIALIZE_ENUM(DynamicsKind, {{DynamicsKind::mlp, "mlp"}, {DynamicsKind::gru, "gru"}})

void to_json(nlohmann::json& json, const ModelSpec& spec) {
  json = {{"touch", spec.touch},
          {"window_frames", spec.window_frames},
          {"rows", spec.rows},
          {"cols", spec.cols},
          {"tactile_kernel", spec.tactile_kernel},
          {"tactile_strides", spec.tactile_strides},
          {"hidden", spec.hidden},
          {"embedding", spec.embedding},
          {"state", spec.state},
          {"band_quantile", spec.band_quantile},
          {"dynamics", spec.dynamics},
          {"activation", name_of(spec.activation)}};
  if (spec.object == ObjectEncoder::none) return;
  json.update({{"object", spec.object},
               {"segment_frames", spec.segment_frames},
               {"contrast_temperature", spec.contrast_temperature}});
}

void from_json(const nlohmann::json& json, ModelSpec& spec) {
  json.at("touch").get_to(spec.touch);
  json.at("window_frames").get_to(spec.window_frames);
  json.at("rows").get_to(spec.rows);
  json.at("cols").get_to(spec.cols);
  spec.tactile_kernel = json.value("tactile_kernel", spec.tactile_kernel);
  spec.tactile_strides = json.value("tactile_strides", spec.tactile_strides);
  json.at("embedding").get_to(spec.embedding);
  json.at("hidden").get_to(spec.hidden);
  json.at("state").get_to(spec.state);
  spec.band_quantile = json.value("band_quantile", spec.band_quantile);
  spec.dynamics = json.value("dynamics", spec.dynamics);
  spec.activation = activation_of(json.value("activation", std::string(name_of(spec.activation))));
  if (!json.contains("object")) return;
  json.at("object").get_to(spec.object);
  json.at("segment_frames").get_to(spec.segment_frames);
  json.at("contrast_temperature").get_to(spec.contrast_temperature);
}

void validate(const ModelSpec& spec) {
  require(spec.hidden >= 64 && spec.hidden <= 1024 && spec.hidden % 64 == 0,
          "hidden layers are a multiple of 64 wide, 1024 at most");
  require(spec.state >= 1 && spec.state <= 16, "state has 1 to 16 values");
  require(spec.band_quantile > 0.0 && spec.band_quantile < 0.5,
          "band lies between the quantiles Q and 1 - Q, 0 < Q < 0.5");
  require(spec.touch || spec.object == ObjectEncoder::none,
          "object encoder needs touch, from which it knows the object");
  if (!spec.touch) return;
  require(spec.tactile_kernel == 3 || spec.tactile_kernel == 5,
          "convolutions over tactile frames have kernels of 3 or 5");
  require(std::ranges::all_of(spec.tactile_strides, [](int s) { return s == 1 || s == 2; }),
          "convolutions over tactile frames have strides of 1 or 2");
  require(spec.embedding >= 16 && spec.embedding <= 1024 && spec.embedding % 16 == 0,
          "embeddings have a multiple of 16 values, 1024 at most");
  require(spec.contrast_temperature >= 0 && spec.contrast_temperature <= 100,
          "contrastive loss has a temperature from 0 (dot products) to 100");
}

}  // namespace touchtrace
