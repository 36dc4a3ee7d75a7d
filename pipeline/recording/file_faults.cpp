#include "pipeline/recording/file_faults.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_listed_faults = 20;
constexpr const char* fault_hint =
    "fix the program that wrote it, or copy or record it again; pipeline/recording/README.md "
    "describes the format";

}  // namespace

void FileFaults::add(const std::string& path, const std::string& fault) {
  if (std::ranges::find(faults_, path, &Fault::path) == faults_.end())
    faults_.push_back({path, fault});
}

bool FileFaults::contains(const std::string& path) const {
  return std::ranges::any_of(faults_, [&](const Fault& fault) {
    return fault.path == path || fault.path.starts_with(path + "/");
  });
}

void FileFaults::throw_if_any(const std::filesystem::path& file) const {
  if (faults_.empty()) return;
  if (faults_.size() == 1)
    throw data_error(fmt::format("{}: {}: {}", file.string(), faults_[0].path, faults_[0].text),
                     fault_hint);
  std::string list;
  for (std::size_t i = 0; i < std::min(faults_.size(), max_listed_faults); ++i)
    list += fmt::format("\n  {}: {}", faults_[i].path, faults_[i].text);
  if (faults_.size() > max_listed_faults)
    list += fmt::format("\n  and {} more", faults_.size() - max_listed_faults);
  throw data_error(fmt::format("{}: {} faults{}", file.string(), faults_.size(), list), fault_hint);
}

std::string attribute_path(const std::string& path, const std::string& name) {
  return fmt::format("{} attribute '{}'", path.empty() ? "/" : path, name);
}

}  // namespace touchtrace
