#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// A part of a data set: `frames` glove frames in total, divided equally among the objects of a
/// role that the activity accepts, or of its default object if `objects` is empty.
struct DataSetPart {
  std::string activity, name, objects;
  double frames;
  int session = 0;  ///< added to the seed: other camera, clocks and motions
};

struct DataSet {
  std::string name, summary;
  std::vector<DataSetPart> parts;
};

const std::vector<DataSet>& data_sets();
/// Throws usage_error with the known names.
const DataSet& find_data_set(const std::string& name);

/// A recording of a data set, and its path in the data set's folder: ACTIVITY/PART/OBJECT.h5.
struct PlannedRecording {
  SceneOptions scene;
  std::filesystem::path file;
};

/// Plans recordings of whole clips with at least `share` of all frames, if no more frames are lost
/// than GloveParameters::lost_fraction. Other options as in `scene`.
std::vector<PlannedRecording> plan_recordings(const DataSet& data_set, const SceneOptions& scene,
                                              double share);

}  // namespace touchtrace::scene
