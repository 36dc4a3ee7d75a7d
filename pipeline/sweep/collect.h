#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace touchtrace::sweep {

/// Writes results.csv, metrics.json, seconds.csv, table.md, table.tex and tensorboard/ from the
/// finished cells of a sweep's folder, and a copy of the report if the study ends in one.
/// `metrics`: columns of the tables; empty: all. Returns the numbers of rows, finished and missing
/// cells, and the table as Markdown.
nlohmann::json collect(const std::filesystem::path& root, const std::vector<std::string>& metrics);

}  // namespace touchtrace::sweep
