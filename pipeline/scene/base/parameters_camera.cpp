#include "pipeline/scene/base/parameter_rows.h"

namespace touchtrace::scene {

void add_camera_parameters(ParameterTable& table) {
  using P = CameraParameters;
  constexpr const char* small_stereo = "typical of small stereo cameras";
  ParameterRows<P> row(table, "camera", &SceneParameters::camera);
  row("focal", &P::focal_px, "px", 200.0, 2000.0, "focal length in an image 640 pixels wide", "",
      small_stereo);
  row("focal-std", &P::focal_std_px, "px", 0.0, 50.0,
      "standard deviation of the focal length among instances", "",
      "factory calibrations differ by as much");
  row("centre-std", &P::centre_std_px, "px", 0.0, 50.0,
      "standard deviation of the principal point from the image centre", "", small_stereo);
  row("k1", &P::k1, "", -0.4, 0.4, "mean radial distortion k1 of the colour lens", "",
      "a lens of 55 degrees");
  row("k2", &P::k2, "", -0.4, 0.4, "mean radial distortion k2 of the colour lens", "",
      "a lens of 55 degrees");
  row("radial-std", &P::radial_std, "", 0.0, 0.1, "standard deviation of k1 and k2 among instances",
      "", "a guess");
  row("tangential", &P::tangential_std, "", 0.0, 0.01,
      "standard deviation of the tangential distortion p1 and p2", "", "a guess");
  row("exposure", &P::exposure_s, "s", 1e-5, 0.05, "exposure time of a colour frame", "",
      "a lit room");
  row("noise", &P::noise_counts, "counts", 0.0, 50.0,
      "standard deviation of a colour pixel, of 255 counts", "", "a lit room");
  row("color-depth-distance", &P::color_depth_distance_m, "m", 0.0, 0.2,
      "distance between the colour and the depth camera", "", small_stereo);
  row("baseline", &P::baseline_m, "m", 0.005, 0.5, "baseline of the stereo pair", "", small_stereo);
  row("disparity-noise", &P::disparity_sigma_px, "px", 0.0, 2.0,
      "standard deviation of the disparity", "axial noise of 2.1 mm at 1.1 m: Nguyen et al. 2012",
      "");
  row("disparity-step", &P::disparity_step_px, "px", 0.0, 2.0, "quantisation of the disparity",
      "eighths of a pixel are usual", "");
  row("shift", &P::shift_sigma_px, "px", 0.0, 5.0,
      "standard deviation of the lateral shift of a depth pixel's ray", "Handa et al. 2014", "");
  row("min-depth", &P::min_depth_m, "m", 0.01, 0.8, "smallest depth that is measured",
      "data sheets: 0.2-0.3 m", "");
  row("max-depth", &P::max_depth_m, "m", 2.5, 100.0, "largest depth that is measured",
      "data sheets: 3-10 m", "");
  row("scale", &P::scale_std, "", 0.0, 0.02, "standard deviation of the depth scale from 1",
      "data sheets: < 2 %", "calibration has to find it");
  row("offset", &P::offset_std_m, "m", 0.0, 0.05, "standard deviation of the depth offset", "",
      "calibration has to find it");
  row("height", &P::height_m, "m", 0.7, 2.0, "height of the camera above the floor", "",
      "it sees all of each activity");
  row("place", &P::place_std_m, "m", 0.0, 0.1,
      "standard deviation of the height and of the lateral position", "",
      "it is set up again for each session");
  row("pitch", &P::pitch_std_deg, "deg", 0.0, 5.0, "standard deviation of the downward pitch", "",
      "it is set up again for each session");
  row("gravity", &P::gravity_std_deg, "deg", 0.0, 10.0,
      "standard deviation of the vertical that its accelerometer measures", "",
      "an offset of 5 mg an axis");
  row("clock", &P::clock_ppm, "ppm", 0.0, 1e4, "standard deviation of the clock's rate",
      "data sheets of quartz: 20-100 ppm", "");
  row("latency-periods", &P::latency_periods, "frame periods", 0.0, 10.0,
      "shortest delay from the middle of the exposure to the arrival, drawn per session",
      "Stereolabs: 2-3 periods for ZED at 15-100 Hz; Azure Kinect SDK, issue 1446: 68 ms at 720p; "
      "librealsense, issue 1242: depth 60-70 ms",
      "cameras differ in read-out, processing and transfer");
  row("jitter", &P::jitter_s, "s", 0.0, 0.5, "mean of the exponential part of the delay", "",
      "a busy host");
  row("dropped", &P::dropped_fraction, "", 0.0, 0.9, "fraction of dropped frames", "",
      "a busy host");
}

}  // namespace touchtrace::scene
