// usage: consumer MODEL LABELS
// Predicts one step with a trained model without object encoder, smooths a track, and reads labels.
#include <cstdio>
#include <vector>

#include "calib/smooth/smooth.h"
#include "engine/cl/device.h"
#include "engine/train/online_predictor.h"
#include "pipeline/recording/labels.h"

int main(int argc, char** argv) {
  using namespace touchtrace;
  if (argc != 3) {
    std::fputs("usage: consumer MODEL LABELS\n", stderr);
    return 2;
  }

  Runtime runtime(choose_device_for_small_steps());
  OnlinePredictor predictor(runtime, argv[1]);
  const ModelSpec& spec = predictor.spec();
  const std::vector<float> frame(static_cast<std::size_t>(spec.rows) * spec.cols, 0.5f);
  const auto [state, spread] = predictor.step(frame);
  std::printf("next state %g, spread %g\n", state[0], spread[0]);

  Track track;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.05 * i;
    track.push_back({t, {0.1 * t, 0.0, 1.0}, {0.002, 0.002, 0.002}});
  }
  const SmoothedTrack smoothed = smooth(track, SmoothOptions{});
  std::printf("velocity %.3f m/s\n", smoothed.smoothed(2.5).velocity_m_per_s.x());

  const Labels labels = read_labels(argv[2]);
  std::printf("%zu labels of %s\n", labels.time_s.size(), labels.activity.c_str());
}
