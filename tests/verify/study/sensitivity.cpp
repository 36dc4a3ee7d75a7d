#include "tests/verify/study/sensitivity.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/scene/base/parameter_registry.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/simulate/simulate.h"
#include "pipeline/study/evaluation.h"
#include "pipeline/study/training.h"
#include "tests/verify/study/simulated_labels.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int rollout_stride = 5;

/// One run: a scene with one scaled parameter, or the default scene if `assumption` is null.
struct Cell {
  const scene::Parameter* assumption;
  double factor;
  int seed;

  json key() const {
    return {{"assumption", assumption ? json(assumption->name) : json()},
            {"factor", factor},
            {"seed", seed}};
  }
  scene::SceneParameters parameters() const {
    scene::SceneParameters parameters;
    if (assumption) scale_parameter(parameters, *assumption, factor);
    return parameters;
  }
};

/// Parameters that match options.only, in that order.
std::vector<const scene::Parameter*> select_parameters(const SensitivityOptions& options) {
  std::vector<const scene::Parameter*> rows;
  for (const std::string& start :
       options.only.empty() ? std::vector<std::string>{""} : options.only) {
    bool known = false;
    for (const scene::Parameter& row : scene::parameter_registry()) {
      if (!row.name.starts_with(scene::current_parameter_name(start))) continue;
      known = true;
      if (std::ranges::find(rows, &row) == rows.end()) rows.push_back(&row);
    }
    if (!known) scene::find_parameter(start);
  }
  return rows;
}

std::vector<Cell> cells_of(const SensitivityOptions& options) {
  std::vector<Cell> cells;
  for (int seed = 1; seed <= options.seeds; ++seed) cells.push_back({nullptr, 1.0, seed});
  for (const scene::Parameter* row : select_parameters(options))
    for (const double factor : {0.5, 2.0}) {
      const Cell cell{row, factor, 1};
      if (row->values(cell.parameters()) != row->values()) cells.push_back(cell);
    }
  return cells;
}

std::string bytes_hash(const auto&... arrays) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(arrays.data()),
                arrays.size() * sizeof(arrays.front())),
   ...);
  return sha256_of(bytes);
}

class Study {
 public:
  Study(Runtime& runtime, const SensitivityOptions& options, json document)
      : runtime_(runtime), options_(options), document_(std::move(document)) {}

  void run(const Cell& cell) {
    json row = cell.key();
    if (done(row)) return;
    const Stopwatch stopwatch;
    if (cell.assumption) row["value"] = cell.assumption->values(cell.parameters());
    try {
      measure(cell, row);
    } catch (const Error& error) {
      if (error.code() != ExitCode::data || !cell.assumption) throw;
      row["failed"] = error.what();
    }
    row["seconds"] = stopwatch.wall_seconds();
    document_["cells"].push_back(row);
    write_file(options_.output, document_.dump(1) + "\n", true);
  }

  const json& document() const { return document_; }

 private:
  bool done(const json& key) const {
    return std::ranges::any_of(document_.at("cells"), [&](const json& row) {
      return std::ranges::all_of(
          key.items(), [&](const auto& item) { return row.at(item.key()) == item.value(); });
    });
  }

  Session simulated(const Cell& cell, json& row) {
    const ScratchFolder folder;
    scene::SceneOptions scene;
    scene.activity = options_.activity;
    scene.object = scene::default_object(options_.activity);
    scene.minutes = options_.clips * scene.clip_s / 60.0;
    scene.seed = static_cast<std::uint64_t>(cell.seed);
    scene.parameters = cell.parameters();
    const fs::path file = folder.path() / "recording.h5";
    const auto summary =
        scene::simulate_recording(scene, options_.images ? &runtime_ : nullptr, file, false,
                                  start_provenance("touchtrace/recording/2", "sensitivity"));
    row["dropped_clips"] = summary.dropped_clips;
    return {"simulated",
            options_.images
                ? load_with_rendered_labels(file, options_.resolution)
                : load_with_modelled_labels(file, measured_label_error(options_.activity),
                                            options_.resolution, scene.seed),
            {}};
  }

  /// Trains a model and adds its L1@50 to the row, or copies it from a cell with the same data.
  void train_and_score(const Session& session, bool touch, json& row) {
    const Dataset& data = session.data;
    const std::string name = touch ? "full" : "without_touch", hash_name = name + "_data";
    const std::string labels = bytes_hash(data.label, data.causal_label, data.trusted, data.truth);
    row[hash_name] = touch ? bytes_hash(labels, data.tactile) : labels;
    for (const json& other : document_["cells"])
      if (other.at("seed") == row["seed"] && other.contains(name) &&
          other.value(hash_name, json()) == row[hash_name]) {
        row[name] = other.at(name), row["random"] = other.value("random", json());
        return;
      }
    const ScratchFolder folder;
    TrainingOptions training;
    training.output = (folder.path() / "model").string();
    training.without_touch = !touch;
    training.window = options_.window;
    training.resolution = options_.resolution;
    training.optimizer.updates = options_.updates;
    training.optimizer.seed = row["seed"];
    Provenance provenance = start_provenance("touchtrace/model/1", "sensitivity");
    provenance.options = json::object();
    train_model(runtime_, data, training, std::move(provenance), true);
    LoadedModel model = load_model(runtime_, training.output);
    const Comparison comparison =
        compare_models({&session}, {&model}, Reference::truth, rollout_stride, 1);
    const auto [object, which] = comparison.objects().front();
    for (const Candidate& candidate : comparison.candidates)
      row[candidate.name] = summary(candidate.runs.front().scores.front(), which)["l1_at_50"];
  }

  void measure(const Cell& cell, json& row) {
    const Session session = simulated(cell, row);
    for (const bool touch : {true, false}) train_and_score(session, touch, row);
  }

  Runtime& runtime_;
  const SensitivityOptions& options_;
  json document_;
};

bool numbers(const json& values) {
  return values.is_array() && std::ranges::all_of(values, &json::is_number);
}

/// Whether a cell of a file has the fields that the study and its table read.
bool is_cell(const json& cell) {
  const auto of = [&](const char* key) { return cell.value(key, json()); };
  return cell.is_object() && of("factor").is_number() && of("seed").is_number_integer() &&
         cell.contains("assumption") &&
         (of("assumption").is_null() || (of("assumption").is_string() && numbers(of("value"))));
}

json options_of(const json& document) {
  const json provenance = document.value("provenance", json());
  return provenance.is_object() ? provenance.value("options", json()) : json();
}

/// New document, or with --resume the one in the output file.
json initial_document(const SensitivityOptions& options, Provenance provenance, bool overwrite) {
  json begun{{"schema", "touchtrace/sensitivity/1"}, {"cells", json::array()}};
  for (const char* harmless : {"resume", "only", "seeds", "output"})
    provenance.options.erase(harmless);
  begun["activity"] = options.activity;
  begun["provenance"] = provenance;
  if (!options.resume || !fs::exists(options.output)) {
    OutputFile(options.output, overwrite);
    return begun;
  }
  json found = json::parse(read_file(options.output), nullptr, false);
  const json cells = found.is_object() ? found.value("cells", json()) : json();
  const char* hint = "use another --output, or --overwrite without --resume";
  if (!cells.is_array() || !std::ranges::all_of(cells, is_cell))
    throw data_error(fmt::format("{} is not a sensitivity study", options.output), hint);
  if (options_of(found) != options_of(begun))
    throw usage_error(fmt::format("{} was made with other options", options.output), hint);
  return found;
}

}  // namespace

void describe(OptionSet& set, SensitivityOptions& o) {
  set.path("output", o.output, "results (.json), saved after each cell");
  set.choice("activity", o.activity, "activity", scene::activity_names());
  set.texts("only", o.only, "parameters or prefixes of their names (default: all)");
  set.integer("seeds", o.seeds, "seeds of the default scene, to measure the spread", 1, 100);
  set.integer("clips", o.clips, "clips of 8 to 12 s", 10, 100000);
  set.integer("updates", o.updates, "weight updates, with and without touch", 1, 10'000'000);
  set.integer("resolution", o.resolution, "tactile rows and columns", 6, 32);
  set.integer("window", o.window, "tactile frames per window", 1, 32);
  set.flag("images", o.images, "labels of rendered images instead of modelled label errors");
  set.flag("resume", o.resume, "keep the cells in the output file");
}

json measure_sensitivity(Runtime& runtime, const SensitivityOptions& options, Provenance provenance,
                         bool overwrite) {
  const auto cells = cells_of(options);
  provenance.device = runtime.device().name;
  Study study(runtime, options, initial_document(options, std::move(provenance), overwrite));
  Progress progress("sensitivity " + options.activity, cells.size());
  for (const Cell& cell : cells) {
    study.run(cell);
    progress.advance(1, cell.assumption
                            ? fmt::format("{} x {:g}", cell.assumption->name, cell.factor)
                            : fmt::format("default, seed {}", cell.seed));
  }
  return study.document();
}

}  // namespace touchtrace::study
