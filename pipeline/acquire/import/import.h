#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/base/options.h"
#include "engine/base/provenance.h"
#include "pipeline/acquire/import/glove_import.h"
#include "pipeline/acquire/import/masks.h"
#include "pipeline/acquire/import/source_camera.h"

namespace touchtrace {

struct ImportOptions {
  SourceOptions source;
  CameraOptions camera;
  std::string masks;  ///< folder; empty: none
  MaskIds mask_ids;
  std::string background;         ///< source of images of the empty scene; empty: none
  std::string background_frames;  ///< "first:last" depth images of this source; empty: none
  std::string activity = "import", object = "object";
  std::string clips;  ///< table; empty: one clip
  GloveOptions glove = {};
};

void describe(OptionSet& set, ImportOptions& options);

/// Converts a source to a recording, image by image, and adds the glove if there is one. Damaged
/// images are reported and skipped. `source` is empty for a glove alone. Returns a summary:
/// numbers of images and glove frames, image sizes, rates, clips. Throws data_error if a file
/// cannot be used or more than half of the images are damaged.
nlohmann::json import_recording(const std::filesystem::path& source,
                                const std::filesystem::path& output, const ImportOptions& options,
                                const Provenance& provenance, bool overwrite);

}  // namespace touchtrace
