#include "pipeline/study/plan.h"

#include <fmt/core.h>

#include <algorithm>

namespace touchtrace::study {
namespace {

std::string tactile_encoder(const ModelSpec& spec) {
  const auto& [a, b, c] = spec.tactile_strides;
  return fmt::format("{} frames of {} x {}; {} x {} taps, strides {}, {}, {}", spec.window_frames,
                     spec.rows, spec.cols, spec.tactile_kernel, spec.tactile_kernel, a, b, c);
}

std::string why_object_encoder(const PlanRequest& request) {
  if (!request.spec.touch) return "model without touch";
  if (request.objects.size() < 2) return "only one object";
  if (request.spec.object == ObjectEncoder::none) return "--object-encoder none";
  return fmt::format(
      "{} objects, identified from {} frames; {}", request.objects.size(),
      request.spec.segment_frames,
      request.spec.object == ObjectEncoder::joint ? "trained jointly" : "embeddings computed once");
}

PlanItem dead_taxels(const PlanRequest& request) {
  const auto layer = window_encoder(request.spec, 1, request.live).layers().front();
  return {"train", "convolution of dead taxels", layer.dead.empty(),
          request.live.empty()
              ? "dead taxels are known once there is a recording"
              : fmt::format("{} dead taxels; {} of {} outputs depend only on these",
                            std::ranges::count(request.live, 0), layer.dead.size(),
                            layer.out_rows() * layer.out_cols())};
}

}  // namespace

std::vector<PlanItem> plan_items(const PlanRequest& request) {
  const auto& [objects, is_simulated, spec, live] = request;
  const bool has_encoder = spec.object != ObjectEncoder::none;
  const std::string given = "the recording is given", no_touch = "model without touch";
  std::vector<PlanItem> items{
      {"simulate", "hand, object and contact", is_simulated,
       is_simulated ? "no recording is given" : given},
      {"simulate", "glove", is_simulated && spec.touch,
       !spec.touch    ? no_touch
       : is_simulated ? "input of the model"
                      : given},
      {"simulate", "camera", is_simulated,
       is_simulated ? "labels come from images, not from the truth" : given},
      {"train", "tactile encoder", spec.touch, spec.touch ? tactile_encoder(spec) : no_touch},
      {"train", "object encoder", has_encoder, why_object_encoder(request)},
      {"train", "contrastive loss", has_encoder,
       spec.object == ObjectEncoder::joint    ? "added to the state loss (equation 6)"
       : spec.object == ObjectEncoder::frozen ? "trains the object encoder first"
                                              : why_object_encoder(request)},
      {"evaluate", "without embedding", has_encoder,
       has_encoder ? "shows the gain of the object embedding" : why_object_encoder(request)},
      {"evaluate", "full", spec.touch, spec.touch ? "shows the gain of touch" : no_touch}};
  if (spec.touch) items.insert(items.begin() + 4, dead_taxels(request));
  return items;
}

}  // namespace touchtrace::study
