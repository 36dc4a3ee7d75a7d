#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace touchtrace {

/// Origin of an output file. Every output contains one as JSON.
struct Provenance {
  struct Input {
    std::string path, sha256;
  };

  std::string schema;      ///< kind and version of the output, e.g. "touchtrace/labels/1"
  std::string command;     ///< "label"
  nlohmann::json options;  ///< all option values, including defaults
  std::uint64_t seed = 0;
  std::vector<Input> inputs;
  std::string device;  ///< OpenCL device; empty if none was used
  double wall_seconds = 0.0, cpu_seconds = 0.0;
  std::string version;  ///< touchtrace version
  std::string created;  ///< UTC, ISO 8601

  /// Adds path and hash of an input file.
  void add_input(const std::filesystem::path& path);
  /// Hash of the first input with the same file name as `path`; empty if there is none.
  std::string input_hash(const std::filesystem::path& path) const;
};

void to_json(nlohmann::json& json, const Provenance& provenance);
void from_json(const nlohmann::json& json, Provenance& provenance);

/// Provenance with schema, command, version and creation time.
Provenance start_provenance(std::string schema, std::string command);

/// Wall and CPU seconds of this process since the construction.
class Stopwatch {
 public:
  Stopwatch();
  double wall_seconds() const;
  double cpu_seconds() const;
  /// Stores both in the provenance.
  void stop(Provenance& provenance) const;

 private:
  double wall_start_s_, cpu_start_s_;
};

}  // namespace touchtrace
