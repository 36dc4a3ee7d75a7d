#include "pipeline/label/label.h"
#include "pipeline/label/track/box_tracker.h"

namespace touchtrace::label {
namespace {

std::vector<std::string> tracker_names() {
  std::vector<std::string> names;
  for (const auto& kind : tracker_kinds()) names.push_back(kind.name);
  return names;
}

}  // namespace

Option& describe_tracker(OptionSet& set, LabelOptions& o) {
  return set.choice("tracker", o.tracker, "component: colour and depth alone, faster",
                    tracker_names());
}

void describe(OptionSet& set, LabelOptions& o) {
  describe_tracker(set, o);
  set.choice(
      "observer", o.observer,
      "what shows hand and object; auto: masks where there are some, colours elsewhere, or masks "
      "alone if half of the frames have one",
      {"auto", "depth-color", "masks"});
  set.flag("no-flights", o.no_flights, "the object never leaves the hand");
  set.numbers("gravity", o.gravity_m_per_s2,
              "gravity in the colour camera's frame [m/s^2]; default: recorded, else 0 9.81 0", 3,
              -100.0, 100.0)
      .value("X Y Z");
  set.numbers("camera-latency", o.camera_latency_s,
              "delay from exposure to time stamp and its standard deviation [s], if measured; "
              "default: from catches or touch, else 1 to 3 frame periods",
              2, 0.0, 1.0)
      .value("DELAY SIGMA");
  set.integer("threads", o.num_threads, "clips in parallel; 0: one per core", 0, 1024);
}

}  // namespace touchtrace::label
