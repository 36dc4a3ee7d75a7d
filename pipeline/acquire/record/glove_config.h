#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/acquire/glove/learn_glove.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Description of a glove in a file that `touchtrace glove --learn --output` wrote.
struct GloveConfig {
  std::string protocol;
  int rows = 0, cols = 0, bits = 0, polarity = 0;
  double rate_hz = 0.0;                ///< nominal
  std::vector<float> baseline_counts;  ///< [rows, cols]
  std::vector<std::string> faults;     ///< why the glove is not fit for use
};

/// Document of a learnt glove; `info`: with which it was learnt.
nlohmann::json glove_config_json(const std::string& protocol, const GloveInfo& info,
                                 const LearnedGlove& learned);

/// Safe for untrusted files. Throws data_error that names the file and the first value that is
/// missing or out of range.
GloveConfig read_glove_config(const std::filesystem::path& path);

}  // namespace touchtrace
