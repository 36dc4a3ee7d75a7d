#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "pipeline/sweep/cells.h"

namespace touchtrace::sweep {

/// Number of cells, of those that are done, and predicted seconds of the others, for every stage
/// and in total. A prediction is the mean over the finished cells of the same command in the folder
/// `root`; null without any. Cells run `jobs` at a time.
nlohmann::json predict(const std::vector<Cell>& cells, const std::vector<bool>& selected,
                       const std::filesystem::path& root, std::size_t jobs);

}  // namespace touchtrace::sweep
