#include "engine/base/provenance.h"

#include <ctime>

#include "engine/base/files.h"
#include "engine/base/version.h"

namespace touchtrace {
namespace {

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace

void Provenance::add_input(const std::filesystem::path& path) {
  inputs.push_back({path.string(), sha256_of_file(path)});
}

std::string Provenance::input_hash(const std::filesystem::path& path) const {
  for (const auto& input : inputs)
    if (std::filesystem::path(input.path).filename() == path.filename()) return input.sha256;
  return {};
}

void to_json(nlohmann::json& json, const Provenance& p) {
  json = {{"schema", p.schema},
          {"command", p.command},
          {"options", p.options},
          {"seed", p.seed},
          {"inputs", nlohmann::json::array()},
          {"device", p.device},
          {"wall_seconds", p.wall_seconds},
          {"cpu_seconds", p.cpu_seconds},
          {"version", p.version},
          {"created", p.created}};
  for (const auto& input : p.inputs)
    json["inputs"].push_back({{"path", input.path}, {"sha256", input.sha256}});
}

void from_json(const nlohmann::json& json, Provenance& p) {
  p.schema = json.at("schema");
  p.command = json.at(json.contains("verb") ? "verb" : "command");  // "verb": former name
  p.options = json.at("options");
  p.seed = json.at("seed");
  for (const auto& input : json.at("inputs"))
    p.inputs.push_back({input.at("path"), input.at("sha256")});
  p.device = json.at("device");
  p.wall_seconds = json.at("wall_seconds");
  p.cpu_seconds = json.at("cpu_seconds");
  p.version = json.at("version");
  p.created = json.at("created");
}

Provenance start_provenance(std::string schema, std::string command) {
  Provenance provenance;
  provenance.schema = std::move(schema);
  provenance.command = std::move(command);
  provenance.version = version;
  provenance.created = utc_now();
  return provenance;
}

Stopwatch::Stopwatch()
    : wall_start_s_(seconds_of(CLOCK_MONOTONIC)),
      cpu_start_s_(seconds_of(CLOCK_PROCESS_CPUTIME_ID)) {}

double Stopwatch::wall_seconds() const { return seconds_of(CLOCK_MONOTONIC) - wall_start_s_; }

double Stopwatch::cpu_seconds() const {
  return seconds_of(CLOCK_PROCESS_CPUTIME_ID) - cpu_start_s_;
}

void Stopwatch::stop(Provenance& provenance) const {
  provenance.wall_seconds = wall_seconds();
  provenance.cpu_seconds = cpu_seconds();
}

}  // namespace touchtrace
