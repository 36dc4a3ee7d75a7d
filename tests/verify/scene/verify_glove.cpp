#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/base/error.h"
#include "engine/base/provenance.h"
#include "engine/base/scratch_folder.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/scene/base/parameter_registry.h"
#include "pipeline/scene/simulate/simulate.h"
#include "tests/verify/scene/glove_statistics.h"
#include "tests/verify/verifications.h"

namespace touchtrace::scene {
namespace {

namespace fs = std::filesystem;

struct Row {
  const char *name, *unit;
  double GloveStatistics::*value;
  double scale;  ///< of the value in the unit
};

constexpr const char* of_scale = "% of scale";
constexpr Row rows[] = {
    {"reading at rest", of_scale, &GloveStatistics::rest_level, 100.0},
    {"spread of the reading at rest", of_scale, &GloveStatistics::rest_spread, 100.0},
    {"noise at rest", of_scale, &GloveStatistics::noise, 100.0},
    {"99th percentile of pressure", of_scale, &GloveStatistics::peak_pressure, 100.0},
    {"taxels above a tenth of the scale", "%", &GloveStatistics::loaded_taxels, 100.0},
    {"saturated readings", "%", &GloveStatistics::saturated_readings, 100.0},
    {"constant taxels", "%", &GloveStatistics::constant_taxels, 100.0},
    {"99th percentile of changes", of_scale, &GloveStatistics::change, 100.0},
    {"correlation, quiet taxels and others", "", &GloveStatistics::quiet_correlation, 1.0},
    {"correlation, neighbours in a row", "", &GloveStatistics::row_correlation, 1.0},
    {"correlation, neighbours in a column", "", &GloveStatistics::column_correlation, 1.0},
    {"correlation, total after 0.5 s", "", &GloveStatistics::correlation_half_second, 1.0},
    {"lost frames", "%", &GloveStatistics::lost_frames, 100.0}};

struct NamedStatistics {
  std::string name;
  GloveStatistics statistics;
};

std::vector<NamedStatistics> recorded_gloves(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".h5") files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<NamedStatistics> gloves;
  for (const fs::path& file : files) {
    const RecordingReader reader(file);
    for (const GloveStream& glove : reader.recording().gloves)
      gloves.push_back({file.stem().string(), glove_statistics(glove)});
  }
  if (gloves.empty())
    throw data_error(folder.string() + " has no recording of a glove",
                     "make some with touchtrace import --glove");
  return gloves;
}

/// Two minutes of an activity.
GloveStatistics simulated_glove(const GloveModel& model, const std::string& activity) {
  SceneOptions options;
  options.activity = activity;
  options.minutes = 2.0;
  options.parameters = parse_parameters(model.settings);
  const ScratchFolder folder;
  const fs::path file = folder.path() / "glove.h5";
  simulate_recording(options, nullptr, file, false,
                     start_provenance("touchtrace/recording/2", "verify"));
  return glove_statistics(RecordingReader(file).recording().gloves.at(0));
}

}  // namespace

Verification verify_gloves(const fs::path& folder) {
  return [folder](const std::function<void(Figure)>& emit) {
    const auto recorded = recorded_gloves(folder);
    std::vector<NamedStatistics> simulated;
    for (const GloveModel& model : glove_models())
      for (const char* activity : {"wave", "throw"})
        simulated.push_back({fmt::format("simulated, {}, {}", model.name, activity),
                             simulated_glove(model, activity)});
    for (const Row& row : rows) {
      std::vector<double> values;
      for (const auto& [name, statistics] : recorded) {
        const double value = row.scale * statistics.*row.value;
        if (std::isfinite(value)) values.push_back(value);
        emit(reported(fmt::format("{}: {}", row.name, name), value, row.unit));
      }
      if (values.empty()) values.push_back(std::nan(""));
      const auto [low, high] = std::ranges::minmax(values);
      for (const auto& [name, statistics] : simulated)
        emit(within(fmt::format("{}: {}", row.name, name), row.scale * statistics.*row.value,
                    row.unit, low, high));
    }
  };
}

}  // namespace touchtrace::scene
