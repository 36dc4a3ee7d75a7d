#include "engine/train/tuning_file.h"

#include <fmt/core.h>

#include <cstdlib>
#include <optional>
#include <string>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/cl/kernel_sources.h"
#include "engine/train/tuning_json.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* file_format = "touchtrace/tuning/1";
constexpr std::uintmax_t max_file_bytes = 16u << 20;

const std::string& hash_of_kernels() {
  static const std::string hash = [] {
    std::string all;
    for (const auto& [name, text] : kernel_sources()) all += fmt::format("{}\n{}\n", name, text);
    return sha256_of(all);
  }();
  return hash;
}

/// Everything that a tuning is valid for.
json key_of(const DeviceInfo& device) {
  return {{"device", device.name},
          {"platform", device.platform},
          {"driver", device.driver},
          {"kernels", hash_of_kernels()}};
}

bool is_of_device(const json& section, const DeviceInfo& device) {
  return section.at("device") == device.name && section.at("platform") == device.platform;
}

/// False for a damaged section.
bool is_of_other_device(const json& section, const DeviceInfo& device) try {
  return !is_of_device(section, device);
} catch (const json::exception&) {
  return false;
}

bool has_key(const json& section, const json& key) {
  for (const auto& [name, value] : key.items())
    if (section.at(name) != value) return false;
  return true;
}

/// Sections of a file, one per device; empty if it is missing, nullopt if it is not a tuning file.
std::optional<json> sections_in(const fs::path& path) try {
  if (!fs::exists(path)) return json::array();
  const auto document = json::parse(read_file(path, max_file_bytes));
  if (document.at("format") != file_format || !document.at("devices").is_array())
    return std::nullopt;
  return document.at("devices");
} catch (const std::exception&) {
  return std::nullopt;
}

void warn(const fs::path& path, const std::string& why) {
  fmt::print(stderr, "warning: tuning in {} ignored: {}; run touchtrace tune to make a new one\n",
             path.string(), why);
}

Tuning tuning_in(const json& sections, const fs::path& path, const DeviceInfo& device) {
  const auto key = key_of(device);
  for (const auto& section : sections) {
    if (!is_of_device(section, device)) continue;
    if (has_key(section, key)) return section.get<Tuning>();
    warn(path, fmt::format("it is for another driver or other kernels of {}", device.name));
  }
  return {};
}

}  // namespace

fs::path tuning_path() {
  constexpr const char* name = "touchtrace/tuning.json";
  const char* cache = std::getenv("XDG_CACHE_HOME");
  // The specification says to ignore relative paths.
  if (cache && fs::path(cache).is_absolute()) return fs::path(cache) / name;
  const char* home = std::getenv("HOME");
  return home && *home ? fs::path(home) / ".cache" / name : fs::path();
}

Tuning read_tuning(const fs::path& path, const DeviceInfo& device) {
  constexpr const char* damaged = "the file is damaged or not a tuning file";
  if (path.empty()) return {};
  const auto sections = sections_in(path);
  if (!sections) return warn(path, damaged), Tuning{};
  try {
    return tuning_in(*sections, path, device);
  } catch (const std::exception&) {
    warn(path, damaged);
    return {};
  }
}

void write_tuning(const fs::path& path, const DeviceInfo& device, const Tuning& tuning) {
  json devices = json::array();
  for (const auto& section : sections_in(path).value_or(json::array()))
    if (is_of_other_device(section, device)) devices.push_back(section);
  json section = key_of(device);
  section.update(json(tuning));
  devices.push_back(std::move(section));
  const json document{{"format", file_format}, {"devices", std::move(devices)}};
  write_file(path, document.dump(1) + "\n", true);
}

}  // namespace touchtrace
