#include "pipeline/scene/base/assumption_rows.h"

namespace touchtrace::scene {

void add_camera_assumptions(AssumptionTable& table) {
  using P = CameraParameters;
  constexpr const char* small_stereo = "as of small stereo cameras";
  AssumptionRows<P> row(table, "camera", &SceneParameters::camera);
  row("focal", &P::focal_px, "px", 200.0, 2000.0, "focal length in an image 640 pixels wide", "no",
      small_stereo);
  row("focal-spread", &P::focal_deviation_px, "px", 0.0, 50.0, "its deviation among specimens",
      "no", "factory calibrations differ by as much");
  row("centre-spread", &P::centre_deviation_px, "px", 0.0, 50.0,
      "the same of the principal point, from the middle", "no", small_stereo);
  row("k1", &P::k1, "", -0.4, 0.4, "mean radial distortion of the colour lens", "no",
      "a lens of 55 degrees");
  row("k2", &P::k2, "", -0.4, 0.4, "the next term of that", "no", "a lens of 55 degrees");
  row("radial-spread", &P::radial_deviation, "", 0.0, 0.1, "deviation of both among specimens",
      "no", "a guess");
  row("tangential", &P::tangential_deviation, "", 0.0, 0.01,
      "deviation of the tangential distortion", "no", "a guess");
  row("exposure", &P::exposure_s, "s", 1e-5, 0.05, "of a colour frame", "no", "a lit room");
  row("noise", &P::noise_counts, "counts", 0.0, 50.0, "of a colour pixel, of 255", "no",
      "a lit room");
  row("apart", &P::apart_m, "m", 0.0, 0.2, "depth's eye from the colour's", "no", small_stereo);
  row("baseline", &P::baseline_m, "m", 0.005, 0.5, "of the stereo pair", "no", small_stereo);
  row("disparity-noise", &P::disparity_sigma_px, "px", 0.0, 2.0, "deviation",
      "axial noise of 2.1 mm at 1.1 m: Nguyen et al. 2012", "");
  row("disparity-step", &P::disparity_step_px, "px", 0.0, 2.0, "of its quantisation",
      "eighths of a pixel are usual", "");
  row("shift", &P::shift_sigma_px, "px", 0.0, 5.0, "deviation of where a pixel of depth looks",
      "Handa et al. 2014", "");
  row("nearest", &P::nearest_m, "m", 0.01, 0.8, "depth that is measured", "data sheets: 0.2-0.3 m",
      "");
  row("farthest", &P::farthest_m, "m", 2.5, 100.0, "the same", "data sheets: 3-10 m", "");
  row("scale", &P::scale_deviation, "", 0.0, 0.02, "deviation of depth's scale from 1",
      "data sheets: < 2 %", "what calibration has to find");
  row("offset", &P::offset_deviation_m, "m", 0.0, 0.05, "deviation of depth's offset", "no",
      "what calibration has to find");
  row("height", &P::height_m, "m", 0.7, 2.0, "of the camera above the floor", "no",
      "it sees all of each activity");
  row("place", &P::place_deviation_m, "m", 0.0, 0.1, "deviation of that, and sideways", "no",
      "it is put up anew for each session");
  row("pitch", &P::pitch_deviation_deg, "deg", 0.0, 5.0, "deviation of how far it looks down", "no",
      "it is put up anew for each session");
  row("gravity", &P::gravity_deviation_deg, "deg", 0.0, 10.0,
      "deviation of the vertical of its accelerometer", "no", "an offset of 5 mg an axis");
  row("clock", &P::clock_ppm, "ppm", 0.0, 1e4, "deviation of its rate",
      "data sheets of quartz: 20-100 ppm", "");
  row("latency", &P::latency_s, "s", 0.0, 0.5,
      "from the middle of the exposure to the arrival, the least", "no",
      "half a frame to read out");
  row("jitter", &P::jitter_s, "s", 0.0, 0.5, "mean of its exponential part", "no", "a busy host");
  row("dropped", &P::dropped, "", 0.0, 0.9, "share of the frames", "no", "a busy host");
}

}  // namespace touchtrace::scene
