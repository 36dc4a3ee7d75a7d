#include "pipeline/scene/base/assumption_rows.h"

namespace touchtrace::scene {
namespace {

void add_glove(AssumptionTable& table) {
  using P = GloveParameters;
  AssumptionRows<P> row(table, "glove", &SceneParameters::glove);
  row("loading-lag", &P::loading_lag_s, "s", 1e-4, 10.0, "of a reading as the force grows",
      "hysteresis of piezoresistive film: yes, value: no", "faster than unloading");
  row("unloading-lag", &P::unloading_lag_s, "s", 1e-4, 10.0, "of a reading as the force falls",
      "hysteresis of piezoresistive film: yes, value: no", "unloading is slower");
  row("creep", &P::creep, "", 0.0, 1.0, "that a lasting force adds to its reading",
      "range published for FSR", "");
  row("creep-time", &P::creep_s, "s", 0.01, 1000.0, "of that", "range published for FSR", "");
  row("gain", &P::gain_deviation, "", 0.0, 2.0, "deviation of the logarithm of a taxel's gain",
      "no", "hand-made arrays");
  row("dead", &P::dead, "", 0.0, 0.9, "share of the taxels", "no", "hand-made arrays");
  row("drift", &P::drift, "", 0.0, 0.9, "amplitude of a gain's slow change", "no",
      "temperature and humidity");
  row("drift-period", &P::drift_period_s, "s", 1.0, 1e5, "of that, drawn for each taxel", "no",
      "temperature and humidity");
  row("saturation", &P::half_saturation_n, "N", 0.01, 1e4,
      "force at half of the full scale: f / (f + it)",
      "form for piezoresistive film: yes, value: no", "a guess");
  row("cross-talk", &P::cross_talk, "", 0.0, 0.2,
      "share of row and column sums, and loading of the row", "arrays < 3.3-3.6 %",
      "read-out without zero potential is worse");
  row("full-scale", &P::full_scale_counts, "counts", 10.0, 5000.0, "of the 10 bit converter", "no",
      "a guess");
  row("noise", &P::noise_counts, "counts", 0.0, 200.0, "deviation", "no", "a guess");
  row("baseline", &P::baseline_counts, "counts", 0.0, 900.0, "mean reading of an untouched taxel",
      "no", "a guess");
  row("baseline-spread", &P::baseline_deviation_counts, "counts", 0.0, 200.0,
      "deviation of that among taxels", "no", "a guess");
  row("scan", &P::scan_s, "s", 0.0, 0.066, "in which the 32 rows of a frame are read",
      "rate of 15 Hz: yes, scan: no", "a guess");
  row("clock", &P::clock_ppm, "ppm", 0.0, 1e4, "deviation of its rate, fixed for a session",
      "data sheets of quartz: 20-100 ppm", "");
  row("latency", &P::latency_s, "s", 0.0, 1.0, "of transport, the least", "no", "USB full speed");
  row("jitter", &P::jitter_s, "s", 0.0, 1.0, "mean of its exponential part", "no", "a busy host");
  row("lost", &P::lost, "", 0.0, 0.9, "share of the frames", "no", "a busy host");
}

void add_inertial(AssumptionTable& table) {
  using P = InertialParameters;
  constexpr const char* sheet = "BMI270's data sheet";
  AssumptionRows<P> row(table, "inertial", &SceneParameters::inertial);
  row("rate", &P::rate_hz, "Hz", 1.0, 1000.0, "of the unit's samples", sheet, "one of its rates");
  row("place-x", &P::place_x_m, "m", -0.3, 0.3,
      "of the unit, from the palm's middle to the fingers", "no", "near the wrist");
  row("place-z", &P::place_z_m, "m", -0.3, 0.3, "of the unit, out of the palm", "no",
      "on the back of the hand");
  row("force-noise", &P::force_noise_g, "g/sqrt(Hz)", 0.0, 0.1, "density", sheet, "");
  row("force-offset", &P::force_offset_g, "g", 0.0, 1.0, "deviation of each axis", sheet, "");
  row("force-range", &P::force_range_g, "g", 1.0, 100.0, "to either side, in 16 bits", sheet, "");
  row("rate-noise", &P::rate_noise_deg_per_s, "deg/s/sqrt(Hz)", 0.0, 10.0, "density", sheet, "");
  row("rate-offset", &P::rate_offset_deg_per_s, "deg/s", 0.0, 100.0, "deviation of each axis",
      sheet, "");
  row("rate-range", &P::rate_range_deg_per_s, "deg/s", 10.0, 1e4, "to either side, in 16 bits",
      sheet, "");
  row("levelling", &P::levelling_s, "s", 0.01, 1e4,
      "in which its vertical follows the specific force", "form: Mahony 2008, value: no",
      "longer than a movement");
}

}  // namespace

void add_glove_assumptions(AssumptionTable& table) {
  add_glove(table);
  add_inertial(table);
}

}  // namespace touchtrace::scene
