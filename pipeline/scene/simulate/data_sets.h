#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {

/// Some recordings of a data set: `frames` of the glove in all, shared out evenly among the objects
/// of a role that the activity takes (or its default object, where `objects` is empty).
struct DataSetPart {
  std::string activity, name, objects;
  double frames;
  int session = 0;  ///< another number: another camera, other clocks, other motions
};

struct DataSet {
  std::string name, summary;
  std::vector<DataSetPart> parts;
};

/// Data sets by name: one row each.
const std::vector<DataSet>& data_sets();
/// Throws usage_error with the known names.
const DataSet& find_data_set(const std::string& name);

/// A recording of a data set, and where it lies in the set's folder: ACTIVITY/PART/OBJECT.h5.
struct PlannedRecording {
  SceneOptions scene;
  std::filesystem::path file;
};

/// Whole clips, at least as many as the frames need where no more are lost than assumed; `share` of
/// all frames. Everything else as `scene` says.
std::vector<PlannedRecording> recordings_of(const DataSet& data_set, const SceneOptions& scene,
                                            double share);

}  // namespace touchtrace::scene
