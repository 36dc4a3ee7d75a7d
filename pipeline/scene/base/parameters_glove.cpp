#include "pipeline/scene/base/parameter_registry.h"
#include "pipeline/scene/base/parameter_rows.h"

namespace touchtrace::scene {
namespace {

void add_glove(ParameterTable& table) {
  using P = GloveParameters;
  ParameterRows<P> row(table, "glove", &SceneParameters::glove);
  row("lag", &P::lag_s, "s", 1e-4, 10.0, "time constant of a reading",
      "Velostat under a load cell (scene/README.md)", "readings were 7 ms apart");
  row("creep", &P::creep, "", 0.0, 2.0,
      "relative increase of the reading per tenfold time under a force, from .05 to 20 s",
      "Velostat and Weiss tactile arrays (scene/README.md)", "");
  row("gain", &P::log_gain_std, "", 0.0, 2.0,
      "standard deviation of the logarithm of a taxel's gain", "", "hand-made arrays");
  row("dead", &P::dead_fraction, "", 0.0, 0.9, "fraction of dead taxels", "", "hand-made arrays");
  row("drift", &P::drift, "", 0.0, 0.9, "relative amplitude of a gain's slow sinusoidal drift", "",
      "temperature and humidity");
  row("drift-period", &P::drift_period_s, "s", 1.0, 1e5, "period of the drift, drawn per taxel", "",
      "temperature and humidity");
  row("saturation", &P::half_saturation_n, "N", 0.01, 1e4,
      "force h that reads half of the full scale: f / (f + h)",
      "a taxel of TAMS: 1.5 to 3.7 N (scene/README.md)", "the middle of three covers");
  row("cross-talk", &P::cross_talk, "", 0.0, 0.2,
      "fraction of row and column sums that leaks into a reading, and loading of the row",
      "arrays: < 3.3-3.6 %", "read-out without zero potential is worse");
  row("full-scale", &P::full_scale_counts, "counts", 10.0, 5000.0,
      "full scale of a reading, of a 10-bit converter", "", "a guess");
  row("noise", &P::noise_counts, "counts", 0.0, 200.0, "standard deviation of a reading", "",
      "a guess");
  row("baseline", &P::baseline_counts, "counts", 0.0, 900.0, "mean reading of an unloaded taxel",
      "", "a guess");
  row("baseline-std", &P::baseline_std_counts, "counts", 0.0, 200.0,
      "standard deviation of the baseline among taxels", "", "a guess");
  row("scan", &P::scan_s, "s", 0.0, 0.066, "time in which the 32 rows of a frame are read",
      "published: rate of 15 Hz, no scan time", "a guess");
  row("clock", &P::clock_ppm, "ppm", 0.0, 1e4,
      "standard deviation of the clock's rate, constant in a session",
      "data sheets of quartz: 20-100 ppm", "");
  row("latency", &P::latency_s, "s", 0.0, 1.0, "shortest transport delay", "", "USB full speed");
  row("jitter", &P::jitter_s, "s", 0.0, 1.0, "mean of the exponential part of the delay", "",
      "a busy host");
  row("lost", &P::lost_fraction, "", 0.0, 0.9, "fraction of lost frames", "", "a busy host");
}

void add_inertial(ParameterTable& table) {
  using P = InertialParameters;
  constexpr const char* sheet = "BMI270's data sheet";
  ParameterRows<P> row(table, "inertial", &SceneParameters::inertial);
  row("rate", &P::rate_hz, "Hz", 1.0, 1000.0, "sample rate", sheet, "one of its rates");
  row("place-x", &P::place_x_m, "m", -0.3, 0.3,
      "position in the hand's frame, from the palm's centre towards the fingers", "",
      "near the wrist");
  row("place-z", &P::place_z_m, "m", -0.3, 0.3, "position in the hand's frame, out of the palm", "",
      "on the back of the hand");
  row("force-noise", &P::force_noise_g, "g/sqrt(Hz)", 0.0, 0.1,
      "noise density of the specific force", sheet, "");
  row("force-offset", &P::force_offset_g, "g", 0.0, 1.0,
      "standard deviation of the specific force's offset, each axis", sheet, "");
  row("force-range", &P::force_range_g, "g", 1.0, 100.0, "+- range of the specific force, 16 bits",
      sheet, "");
  row("rate-noise", &P::rate_noise_deg_per_s, "deg/s/sqrt(Hz)", 0.0, 10.0,
      "noise density of the angular velocity", sheet, "");
  row("rate-offset", &P::rate_offset_deg_per_s, "deg/s", 0.0, 100.0,
      "standard deviation of the angular velocity's offset, each axis", sheet, "");
  row("rate-range", &P::rate_range_deg_per_s, "deg/s", 10.0, 1e4,
      "+- range of the angular velocity, 16 bits", sheet, "");
  row("levelling", &P::levelling_s, "s", 0.01, 1e4,
      "time constant in which the estimated vertical follows the specific force",
      "Mahony 2008 (form only)", "longer than a movement");
}

}  // namespace

/// actionsense: levels of published frames of a 32 x 32 glove of ActionSense (README.md).
const std::vector<GloveModel>& glove_models() {
  static const std::vector<GloveModel> models{
      {"default", {}},
      {"actionsense",
       {"glove-baseline=564", "glove-baseline-std=3", "glove-noise=1.2", "glove-full-scale=459",
        "glove-saturation=6", "glove-cross-talk=0"}}};
  return models;
}

std::vector<std::string> glove_model_names() {
  std::vector<std::string> names;
  for (const GloveModel& model : glove_models()) names.push_back(model.name);
  return names;
}

void add_glove_parameters(ParameterTable& table) {
  add_glove(table);
  add_inertial(table);
}

}  // namespace touchtrace::scene
