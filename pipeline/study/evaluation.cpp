#include "pipeline/study/evaluation.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "engine/base/error.h"
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
                     "only simulated ones do; use --against labels");
  return Reference::labels;
}

void require_fit(const LoadedModel& model, const Session& session) {
  const ModelSpec& spec = model.card.spec;
  const Dataset& data = session.data;
  if (spec.touch && (spec.rows != data.rows || spec.cols != data.cols))
    throw data_error(fmt::format("{} needs frames of {} x {}, {} has {} x {}", model.path,
                                 spec.rows, spec.cols, session.name, data.rows, data.cols),
                     "evaluate on recordings of the glove that it was trained on");
}

std::vector<const Session*> sessions_of(const std::vector<Session>& sessions,
                                        const LoadedModel& model) {
  std::vector<const Session*> found;
  for (const Session& session : sessions)
    if (session.data.activity == model.card.activity) found.push_back(&session);
  if (found.empty())
    throw data_error(
        fmt::format("no recording of activity '{}' for {}", model.card.activity, model.path),
        "add one with --recording and --labels");
  for (const Session* session : found) require_fit(model, *session);
  return found;
}

json card_json(const LoadedModel& model) {
  json card = model.card;
  card["model"] = model.card.name();
  card["path"] = model.path;
  return card;
}

}  // namespace

void describe(OptionSet& set, EvaluationOptions& o) {
  set.group("Files");
  set.paths("recording", o.recordings, "recordings; only their evaluation clips are used")
      .value("FILE");
  set.paths("labels", o.labels, "label files, in the same order").value("FILE");
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

json evaluate_models(const std::vector<Session>& sessions, std::vector<LoadedModel>& models,
                     const EvaluationOptions& options) {
  const Reference reference = choose_reference(sessions, options.against);
  json document{{"schema", "touchtrace/metrics/1"},
                {"against", reference == Reference::truth ? "truth" : "labels"}};
  for (const char* key : {"results", "differences", "curves", "examples", "models", "label_errors"})
    document[key] = json::array();
  std::set<std::string> activities;
  for (const LoadedModel& model : models) activities.insert(model.card.activity);
  for (const std::string& activity : activities) {
    std::vector<LoadedModel*> candidates;
    for (LoadedModel& model : models)
      if (model.card.activity == activity) candidates.push_back(&model);
    const Comparison comparison =
        compare_models(sessions_of(sessions, *candidates.front()), candidates, reference,
                       options.stride, options.seed);
    append_results(document, comparison, options.seed);
    append_examples(document, comparison);
    document["scaling"][activity] = {{"mean", comparison.scaling.mean},
                                     {"deviation", comparison.scaling.sigma}};
  }
  for (const LoadedModel& model : models) document["models"].push_back(card_json(model));
  for (const Session& session : sessions)
    if (!session.label_error.is_null())
      document["label_errors"].push_back(
          {{"recording", session.name}, {"error", session.label_error}});
  return document;
}

}  // namespace touchtrace::study
