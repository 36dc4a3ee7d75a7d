#include "pipeline/study/evaluation.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "pipeline/study/evaluation_clips.h"
#include "pipeline/study/results.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;

bool all_have_truth(const std::vector<Session>& sessions) {
  return std::ranges::none_of(sessions,
                              [](const Session& session) { return session.data.truth.empty(); });
}

Reference choose_reference(const std::vector<Session>& sessions, const std::string& against) {
  if (against == "labels") return Reference::labels;
  if (all_have_truth(sessions)) return Reference::truth;
  if (against == "truth")
    throw data_error("not all recordings have a truth",
                     "use --against labels: only simulated recordings have a truth");
  return Reference::labels;
}

std::vector<const Session*> sessions_of(const std::vector<Session>& sessions,
                                        const std::vector<LoadedModel*>& models) {
  const std::string& activity = models.front()->card.activity;
  std::vector<const Session*> found;
  for (const Session& session : sessions)
    if (session.data.activity == activity) found.push_back(&session);
  if (found.empty())
    throw data_error(
        fmt::format("no recording of activity '{}' for {}", activity, models.front()->path),
        "add one with --recording and --labels");
  for (const Session* session : found)
    for (const LoadedModel* model : models)
      require_rate(model->card, model->path, session->data.rate_hz, session->name);
  return found;
}

/// Recordings whose labels may be in other units than a model's.
void note_spread(const std::vector<const Session*>& sessions, const LoadedModel& model,
                 json& notes) {
  constexpr double max_ratio = 5.0;
  for (const Session* session : sessions) {
    const auto labels = fit_normalization_of_all_clips(session->data);
    if (!labels) continue;
    const double ratio = labels->position_spread_m() / model.card.scaling.position_spread_m();
    if (!(ratio >= 1.0 / max_ratio && ratio <= max_ratio))
      notes.push_back(fmt::format(
          "positions of {} spread {:.3g} times as far as those that {} was trained on: are both in "
          "metres?",
          session->name, ratio, model.path));
  }
}

/// Properties in which compared models should agree.
void note_mismatches(const std::vector<LoadedModel*>& models, json& notes) {
  const LoadedModel& first = *models.front();
  for (const LoadedModel* model : models) {
    if (model->card.objects != first.card.objects)
      notes.push_back(fmt::format("{} was trained on other objects than {}: {} instead of {}",
                                  model->path, first.path, fmt::join(model->card.objects, ", "),
                                  fmt::join(first.card.objects, ", ")));
    if (const auto difference = training_difference(first, *model);
        model->card.name() != first.card.name() && !difference.empty())
      notes.push_back(fmt::format("{} and {} were trained differently: {}", first.path, model->path,
                                  difference));
    if (model->card.scaling.sigma != first.card.scaling.sigma)
      notes.push_back(
          fmt::format("{} was trained on other labels than {}; errors of both are in "
                      "standard deviations of the latter's labels",
                      model->path, first.path));
  }
}

void note_clips(const std::vector<std::string>& whole, json& notes) {
  if (!whole.empty())
    notes.push_back(
        fmt::format("all clips are evaluated, as their touch and motion are those of no clip that "
                    "a model was trained on: {}",
                    fmt::join(whole, ", ")));
}

/// Warnings of the evaluated recordings and of those that the models were trained on.
void note_warnings(const std::vector<Session>& sessions, const std::vector<LoadedModel>& models,
                   json& notes) {
  std::set<std::string> warnings;
  for (const Session& session : sessions)
    warnings.insert(session.data.warnings.begin(), session.data.warnings.end());
  for (const LoadedModel& model : models)
    warnings.insert(model.card.warnings.begin(), model.card.warnings.end());
  for (const auto& warning : warnings) notes.push_back(warning);
}

void note_bands(const std::vector<LoadedModel*>& models, json& notes) {
  for (const LoadedModel* model : models)
    if (model->card.band_scale.empty())
      notes.push_back(
          fmt::format("{} has no rescaled coverage: its recordings had no calibration clips (clip "
                      "8, 28, ... of "
                      "an object)",
                      model->path));
}

void note_baselines(const Comparison& comparison, json& notes) {
  if (!comparison.find("linear"))
    notes.push_back(
        fmt::format("{}: the baselines damped, median and linear need a recording that "
                    "the models were trained on",
                    comparison.sessions.front()->data.activity));
}

json card_json(const LoadedModel& model) {
  json card = model.card;
  card["model"] = model.card.name();
  card["path"] = model.path;
  return card;
}

json label_error_json(const Session& session) {
  const State& offset = session.data.truth_offset;
  const auto metres = [&](Dimensions dimensions) {
    return std::vector<float>(&offset[dimensions.first],
                              &offset[dimensions.first] + dimensions.count);
  };
  return {
      {"recording", session.name},
      {"error", session.label_error},
      {"truth_offset_m", {{"object", metres(object_position)}, {"hand", metres(hand_position)}}}};
}

}  // namespace

void describe(OptionSet& set, EvaluationOptions& o) {
  set.group("Files");
  set.paths("recording", o.recordings,
            "recordings, or folders of them; of those that a model was trained on only the "
            "evaluation clips")
      .value("FILE");
  set.texts("labels", o.labels, "label files, in the same order; default: X.labels.h5 of X.h5")
      .value("FILE");
  set.paths("model", o.models, "models; each is evaluated on the recordings of its activity")
      .value("FILE");
  set.text("output", o.output, "metrics (.json), for `report`").value("FILE");
  set.group("Evaluation");
  set.choice("against", o.against, "reference states; auto: truth if recorded, else labels",
             {"auto", "truth", "labels"});
  set.integer("stride", o.stride, "frames between starts of roll-outs", 1, 1000);
  set.choice("accuracy", o.accuracy, "exact: denormals, compensated sums, no Winograd",
             {"fast", "exact"});
  set.seed("seed", o.seed, "baseline Random and bootstrap");
}

LoadedModel load_model(Runtime& runtime, const std::string& path) {
  auto predictor = std::make_unique<Predictor>(runtime, path);
  ModelCard card = read_card(predictor->metadata(), path);
  return {path, std::move(card), std::move(predictor)};
}

json evaluate_models(std::vector<Session> sessions, std::vector<LoadedModel>& models,
                     const EvaluationOptions& options) {
  const Reference reference = choose_reference(sessions, options.against);
  json document{{"schema", "touchtrace/metrics/2"},
                {"against", reference == Reference::truth ? "truth" : "labels"},
                {"main_metrics",
                 {"l1_at_20", "l1_at_50", "hausdorff", "coverage", "object_error_m_at_50",
                  "object_error_m_per_s_at_50"}}};
  for (const char* key :
       {"results", "runs", "differences", "curves", "examples", "models", "label_errors", "notes"})
    document[key] = json::array();
  note_clips(choose_evaluation_clips(sessions, models), document["notes"]);
  note_warnings(sessions, models, document["notes"]);
  std::map<std::string, std::vector<LoadedModel*>> by_activity;
  for (LoadedModel& model : models) by_activity[model.card.activity].push_back(&model);
  for (const auto& [activity, candidates] : by_activity) {
    note_mismatches(candidates, document["notes"]);
    note_bands(candidates, document["notes"]);
    const Comparison comparison = compare_models(sessions_of(sessions, candidates), candidates,
                                                 reference, options.stride, options.seed);
    note_baselines(comparison, document["notes"]);
    note_spread(comparison.sessions, *candidates.front(), document["notes"]);
    append_results(document, comparison, options.seed);
    append_examples(document, comparison);
    document["scaling"][activity] = {{"mean", comparison.scaling.mean},
                                     {"deviation", comparison.scaling.sigma},
                                     {"model", candidates.front()->path}};
  }
  for (const LoadedModel& model : models) document["models"].push_back(card_json(model));
  for (const Session& session : sessions)
    if (!session.label_error.is_null())
      document["label_errors"].push_back(label_error_json(session));
  return document;
}

}  // namespace touchtrace::study
