#include "tests/verify/study/noise_model.h"

#include "engine/train/noise_batch.h"
#include "engine/train/trainer.h"
#include "pipeline/study/model_card.h"

namespace touchtrace {
namespace {

constexpr int frames = 60, sequences = 6, steps = 4, updates = 3;

study::ModelCard card_of(const ModelSpec& spec, double rate_hz) {
  study::ModelCard card;
  card.spec = spec;
  for (int d = 0; d < state_size; ++d) {
    card.scaling.mean[d] = 0.1f * static_cast<float>(d);
    card.scaling.sigma[d] = 0.5f + 0.01f * static_cast<float>(d);
  }
  card.activity = "noise";
  card.objects = {"noise"};
  card.rate_hz = rate_hz;
  card.band_scale = {1.5, 1.25};
  card.provenance = start_provenance("touchtrace/model/1", "train");
  if (spec.object != ObjectEncoder::none)
    for (int i = 0; i < spec.embedding; ++i)
      card.mean_embedding.push_back(0.01f * static_cast<float>(i));
  return card;
}

}  // namespace

void write_noise_model(Runtime& runtime, const std::filesystem::path& path, const ModelSpec& spec,
                       double rate_hz) {
  RandomStream random(1, "noise model");
  TrainOptions options;
  options.updates = updates;
  const auto stream = spec.touch ? noise_stream(spec, frames, random) : std::vector<float>();
  Trainer trainer(runtime, spec, options, sequences, steps, stream);
  for (int i = 0; i < updates; ++i)
    trainer.update(noise_batch(spec, sequences, steps, frames, random));
  trainer.save(path, card_of(spec, rate_hz), true);
}

}  // namespace touchtrace
