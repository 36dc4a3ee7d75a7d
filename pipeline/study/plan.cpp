#include "pipeline/study/plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

namespace touchtrace::study {
namespace {

/// What an activity can hold. One that is not known may hold everything.
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
  explicit Planner(const PlanWishes& wishes)
      : wishes_(wishes), traits_(traits_of(wishes.activity)) {
    plan_.model.touch = wishes.touch;
    plan_.model.dynamics = dynamics_of(wishes.dynamics);
    plan_.model.window_frames = wishes.window_frames;
    plan_.model.rows = wishes.rows;
    plan_.model.cols = wishes.cols;
    plan_.model.tactile_kernel = wishes.tactile_kernel;
    plan_.model.tactile_strides = wishes.tactile_strides;
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
    const bool simulated = wishes_.simulated;
    add("simulate", "hand, object and contact", simulated,
        simulated ? "no recording is given" : "the recording is given");
    add("simulate", "glove", simulated && wishes_.touch,
        !wishes_.touch ? "touch is not wanted"
        : simulated    ? "the model feels through it"
                       : "the recording is given");
    add("simulate", "camera", simulated,
        simulated ? "labels come from images, never from the truth" : "the recording is given");
    add("calibrate", "colour and depth camera", true, "labels are in metres");
  }

  void plan_labels() {
    const std::string only = fmt::format("nothing flies in {}", wishes_.activity);
    add("label", "hand and object tracks", true, "the state holds both (equation 2)");
    const auto& [tracker, why] = wishes_.tracker;
    add("label", "--tracker " + tracker, true, why);
    add("label", "contact events (release, catch)", traits_.flight,
        traits_.flight ? "the object leaves the hand" : only);
    add("label", "impact events", traits_.impacts,
        traits_.impacts ? "velocity jumps at an impact; looked for if the object falls freely in "
                          "most frames, whatever the activity is called"
                        : fmt::format("nothing bounces in {}", wishes_.activity));
  }

  void plan_model() {
    const std::string no_touch = "touch is not wanted";
    const auto object = plan_.model.object;
    add("train", "tactile encoder", wishes_.touch, wishes_.touch ? tactile_encoder() : no_touch);
    if (wishes_.touch) plan_dead_taxels();
    add("train", "object encoder", object != ObjectEncoder::none, why_object_encoder());
    add("train", "contrastive loss", object != ObjectEncoder::none,
        object == ObjectEncoder::joint    ? "added to the loss of the states (equation 6)"
        : object == ObjectEncoder::frozen ? "trains the object encoder, before all else"
                                          : why_object_encoder());
    add("train", wishes_.dynamics == "gru" ? "dynamics GRU with band" : "dynamics MLP with band",
        true, "predicts the state and two quantiles");
    add("train", "gradient towards tactile frames", false, "nothing learns from it");
    add("train", "gradient towards initial states", false, "nothing learns from it");
  }

  void plan_dead_taxels() {
    const auto layer = window_encoder(plan_.model, 1, wishes_.live).layers().front();
    const auto taxels = std::ranges::count(wishes_.live, 0);
    add("train", "convolution of dead taxels", layer.dead.empty(),
        wishes_.live.empty()
            ? "which are dead is known when the recording is"
            : fmt::format("{} taxels are dead; {} of {} outputs see no other", taxels,
                          layer.dead.size(), layer.out_rows() * layer.out_cols()));
  }

  void plan_evaluation() {
    add("evaluate", "random", true, "another trajectory of the data set: the floor");
    add("evaluate", "without touch", true, "what the state alone can predict");
    add("evaluate", "without embedding", plan_.model.object != ObjectEncoder::none,
        plan_.model.object != ObjectEncoder::none ? "what knowing the object adds"
                                                  : why_object_encoder());
    add("evaluate", "full", wishes_.touch,
        wishes_.touch ? "what touch adds" : "touch is not wanted");
  }

  std::string tactile_encoder() const {
    const auto& [a, b, c] = wishes_.tactile_strides;
    return fmt::format("{} frames of {} x {}; {} x {} taps, strides {}, {}, {}",
                       wishes_.window_frames, wishes_.rows, wishes_.cols, wishes_.tactile_kernel,
                       wishes_.tactile_kernel, a, b, c);
  }

  /// With one object there is nothing to tell apart, and objects are known by touch.
  bool can_tell_objects() const { return wishes_.touch && wishes_.objects.size() > 1; }

  ObjectEncoder object_encoder() const {
    if (!can_tell_objects() || wishes_.object_encoder == "none") return ObjectEncoder::none;
    return wishes_.object_encoder == "joint" ? ObjectEncoder::joint : ObjectEncoder::frozen;
  }

  std::string why_object_encoder() const {
    if (!wishes_.touch) return "touch is not wanted";
    if (!can_tell_objects()) return "one object: nothing to tell apart";
    if (wishes_.object_encoder == "none") return "not wanted";
    return fmt::format(
        "{} objects, known from {} frames; {}", wishes_.objects.size(), plan_.model.segment_frames,
        plan_.model.object == ObjectEncoder::joint ? "trained along" : "embeddings computed once");
  }

  PlanWishes wishes_;
  ActivityTraits traits_;
  Plan plan_;
};

}  // namespace

Plan make_plan(const PlanWishes& wishes) { return Planner(wishes).make(); }

nlohmann::json plan_json(const PlanWishes& wishes, const Plan& plan) {
  nlohmann::json items = nlohmann::json::array();
  for (const auto& item : plan.items)
    items.push_back({{"stage", item.stage},
                     {"part", item.part},
                     {"included", item.included},
                     {"why", item.why}});
  return {{"activity", wishes.activity},
          {"objects", wishes.objects},
          {"model", plan.model},
          {"items", items}};
}

}  // namespace touchtrace::study
