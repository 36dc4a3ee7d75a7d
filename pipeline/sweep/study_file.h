#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace touchtrace::sweep {

struct StageTable {
  std::string name;
  nlohmann::json table;
};

/// Tables of a TOML file in the order of the file. Throws usage_error.
std::vector<StageTable> read_stage_tables(const std::filesystem::path& file);

/// Applies "STAGE.OPTION=VALUE[,VALUE...]". FIRST:LAST is a range of whole numbers; for an axis of
/// named cases the values select cases. Throws usage_error.
void apply_change(std::vector<StageTable>& tables, const std::string& change);

}  // namespace touchtrace::sweep
