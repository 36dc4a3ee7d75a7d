#include "pipeline/acquire/import/import.h"

namespace touchtrace {

void describe(OptionSet& set, ImportOptions& o) {
  set.text("clips", o.clips, "table with start_s, end_s, object; default: one clip").value("FILE");
  set.text("object", o.object, "name of the object").value("NAME");
  set.text("activity", o.activity, "name of the activity").value("NAME");
  set.group("Camera");
  set.text("camera-info", o.camera.camera_info,
           "intrinsics: camera_info, OpenCV or kalibr YAML, 3x3 matrix, folder from `calibrate`; "
           "default: in the folder of the images, or in the bag")
      .value("FILE");
  set.flag("registered", o.camera.registered,
           "depth is on the colour camera's pixels, or shows the same view at another size");
  set.flag("no-registered", o.camera.no_registered,
           "depth is on its own camera's pixels; --camera-info then "
           "has both cameras and their pose: folder from `calibrate`, kalibr's camchain.yaml "
           "(cam0: colour, cam1: depth)");
  set.number("depth-scale", o.camera.depth_scale,
             "depth counts per metre; default: 5000 of TUM folders, 1000, metres of floating-point "
             "depth",
             0.0, 1e6)
      .value("N");
  set.number("depth-offset", o.camera.depth_offset_s, "added to the depth images' times", -1e3, 1e3)
      .value("SECONDS");
  set.numbers("gravity", o.camera.gravity_m_per_s2,
              "gravity in the colour camera's frame (x right, y down, z forward) [m/s^2]", 3, -20.0,
              20.0)
      .value("X Y Z");
  set.group("Images");
  set.number("rate", o.source.rate_hz,
             "rate of images and glove tables without time stamps; 0: they have stamps", 0.0, 1e4)
      .value("HZ");
  set.text("color-topic", o.source.color_topic, "topic of colour images in a bag").value("TOPIC");
  set.text("depth-topic", o.source.depth_topic, "topic of depth images in a bag").value("TOPIC");
  set.text("masks", o.masks, "folder of instance masks of colour images (PNG)").value("DIR");
  set.integer("hand-id", o.mask_ids.hand, "instance of the hand in masks", 1, 65535);
  set.integer("object-id", o.mask_ids.object, "instance of the object in masks", 1, 65535);
  set.text("background", o.background, "images of the empty scene: a source like SOURCE")
      .value("PATH");
  set.text("background-frames", o.background_frames,
           "depth images of SOURCE without person and object, first and last, e.g. 0:20")
      .value("A:B");
  describe(set, o.glove);
}

}  // namespace touchtrace
