#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace touchtrace {

/// What made an artefact; every artefact carries one, as JSON.
struct Provenance {
  struct Input {
    std::string path, sha256;
  };

  std::string schema;      ///< what the artefact is and its version, e.g. "touchtrace/labels/1"
  std::string verb;        ///< the verb that made it
  nlohmann::json options;  ///< every option's value, defaults included
  std::uint64_t seed = 0;
  std::vector<Input> inputs;
  std::string device;  ///< OpenCL device, empty where none was used
  double wall_seconds = 0.0, cpu_seconds = 0.0;
  std::string version;  ///< of touchtrace
  std::string created;  ///< UTC, ISO 8601

  void add_input(const std::filesystem::path& path);
  /// The recorded hash of the first input whose file name is `path`'s; empty if there is none.
  std::string input_hash(const std::filesystem::path& path) const;
};

void to_json(nlohmann::json& json, const Provenance& provenance);
void from_json(const nlohmann::json& json, Provenance& provenance);

/// A provenance with schema, verb, version and time filled in.
Provenance start_provenance(std::string schema, std::string verb);

/// Wall and processor seconds of this process since the construction.
class Stopwatch {
 public:
  Stopwatch();
  double wall_seconds() const;
  double cpu_seconds() const;
  /// Writes both into the provenance.
  void stop(Provenance& provenance) const;

 private:
  double wall_start_s_, cpu_start_s_;
};

}  // namespace touchtrace
