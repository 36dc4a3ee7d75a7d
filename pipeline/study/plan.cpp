#include "pipeline/study/plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

namespace touchtrace::study {
namespace {

/// Event types that an activity contains; unknown activities may contain all.
struct ActivityTraits {
  bool flight = true, impacts = true;
};

ActivityTraits traits_of(const std::string& activity) {
  static const std::map<std::string, ActivityTraits> table{{"wave", {false, false}},
                                                           {"throw", {true, false}},
                                                           {"pingpong", {true, true}},
                                                           {"balance", {false, false}}};
  const auto row = table.find(activity);
  return row == table.end() ? ActivityTraits{} : row->second;
}

class Planner {
 public:
  explicit Planner(const PlanRequest& request)
      : request_(request), traits_(traits_of(request.activity)) {
    plan_.model.touch = request.touch;
    plan_.model.dynamics = dynamics_of(request.dynamics);
    plan_.model.window_frames = request.window_frames;
    plan_.model.rows = request.rows;
    plan_.model.cols = request.cols;
    plan_.model.tactile_kernel = request.tactile_kernel;
    plan_.model.tactile_strides = request.tactile_strides;
    plan_.model.object = object_encoder();
  }

  Plan make() {
    plan_data();
    plan_labels();
    plan_model();
    plan_evaluation();
    return plan_;
  }

 private:
  void add(const char* stage, std::string part, bool included, std::string why) {
    plan_.items.push_back({stage, std::move(part), included, std::move(why)});
  }

  void plan_data() {
    const bool simulated = request_.simulated;
    add("simulate", "hand, object and contact", simulated,
        simulated ? "no recording is given" : "the recording is given");
    add("simulate", "glove", simulated && request_.touch,
        !request_.touch ? "model without touch"
        : simulated     ? "input of the model"
                        : "the recording is given");
    add("simulate", "camera", simulated,
        simulated ? "labels come from images, not from the truth" : "the recording is given");
    add("calibrate", "colour and depth camera", true, "metric labels");
  }

  void plan_labels() {
    const std::string no_flight = fmt::format("no flight in {}", request_.activity);
    add("label", "hand and object tracks", true, "the state contains both (equation 2)");
    add("label", "contact events (release, catch)", traits_.flight,
        traits_.flight ? "the object leaves the hand" : no_flight);
    add("label", "impact events", traits_.impacts,
        traits_.impacts ? "velocity jumps at hits between two flights"
                        : fmt::format("no impacts in {}", request_.activity));
  }

  void plan_model() {
    const std::string no_touch = "model without touch";
    const auto object = plan_.model.object;
    add("train", "tactile encoder", request_.touch, request_.touch ? tactile_encoder() : no_touch);
    if (request_.touch) plan_dead_taxels();
    add("train", "object encoder", object != ObjectEncoder::none, why_object_encoder());
    add("train", "contrastive loss", object != ObjectEncoder::none,
        object == ObjectEncoder::joint    ? "added to the state loss (equation 6)"
        : object == ObjectEncoder::frozen ? "trains the object encoder first"
                                          : why_object_encoder());
    add("train", request_.dynamics == "gru" ? "dynamics GRU with band" : "dynamics MLP with band",
        true, "predicts the state and two quantiles");
    add("train", "gradient with respect to tactile frames", false, "no parameters below");
    add("train", "gradient with respect to initial states", false, "no parameters below");
  }

  void plan_dead_taxels() {
    const auto layer = window_encoder(plan_.model, 1, request_.live).layers().front();
    const auto taxels = std::ranges::count(request_.live, 0);
    add("train", "convolution of dead taxels", layer.dead.empty(),
        request_.live.empty()
            ? "dead taxels are known once there is a recording"
            : fmt::format("{} dead taxels; {} of {} outputs depend only on these", taxels,
                          layer.dead.size(), layer.out_rows() * layer.out_cols()));
  }

  void plan_evaluation() {
    add("evaluate", "random", true, "baseline: trajectory of another time");
    add("evaluate", "without touch", true, "baseline: prediction from the state alone");
    add("evaluate", "without embedding", plan_.model.object != ObjectEncoder::none,
        plan_.model.object != ObjectEncoder::none ? "shows the gain of the object embedding"
                                                  : why_object_encoder());
    add("evaluate", "full", request_.touch,
        request_.touch ? "shows the gain of touch" : "model without touch");
  }

  std::string tactile_encoder() const {
    const auto& [a, b, c] = request_.tactile_strides;
    return fmt::format("{} frames of {} x {}; {} x {} taps, strides {}, {}, {}",
                       request_.window_frames, request_.rows, request_.cols,
                       request_.tactile_kernel, request_.tactile_kernel, a, b, c);
  }

  /// Objects are identified by touch, and one object needs no identification.
  bool needs_object_encoder() const { return request_.touch && request_.objects.size() > 1; }

  ObjectEncoder object_encoder() const {
    if (!needs_object_encoder() || request_.object_encoder == "none") return ObjectEncoder::none;
    return request_.object_encoder == "joint" ? ObjectEncoder::joint : ObjectEncoder::frozen;
  }

  std::string why_object_encoder() const {
    if (!request_.touch) return "model without touch";
    if (!needs_object_encoder()) return "only one object";
    if (request_.object_encoder == "none") return "--object-encoder none";
    return fmt::format("{} objects, identified from {} frames; {}", request_.objects.size(),
                       plan_.model.segment_frames,
                       plan_.model.object == ObjectEncoder::joint ? "trained jointly"
                                                                  : "embeddings computed once");
  }

  PlanRequest request_;
  ActivityTraits traits_;
  Plan plan_;
};

}  // namespace

Plan make_plan(const PlanRequest& request) { return Planner(request).make(); }

nlohmann::json plan_json(const PlanRequest& request, const Plan& plan) {
  nlohmann::json items = nlohmann::json::array();
  for (const auto& item : plan.items)
    items.push_back({{"stage", item.stage},
                     {"part", item.part},
                     {"included", item.included},
                     {"why", item.why}});
  return {{"activity", request.activity},
          {"objects", request.objects},
          {"model", plan.model},
          {"items", items}};
}

}  // namespace touchtrace::study
