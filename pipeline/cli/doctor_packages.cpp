#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "pipeline/acquire/record/camera_source.h"
#include "pipeline/cli/doctor.h"
#include "pipeline/cli/packages.h"

namespace touchtrace::cli {
namespace {

constexpr const char* dpkg_status = "/var/lib/dpkg/status";

Finding check_installed(const std::vector<std::string>& wanted,
                        const std::set<std::string>& installed, const std::string& purpose) {
  std::vector<std::string> missing;
  std::ranges::copy_if(wanted, std::back_inserter(missing),
                       [&](const auto& name) { return !installed.contains(name); });
  if (missing.empty())
    return {Finding::State::good,
            fmt::format("all {} packages for {} are installed", wanted.size(), purpose), ""};
  return {Finding::State::advice,
          fmt::format("missing packages for {}: {}", purpose, fmt::join(missing, " ")),
          fmt::format("sudo apt-get install {}", fmt::join(missing, " "))};
}

Finding check_camera_library(const char* name, const char* package, bool is_built_in) {
  if (is_built_in) return {Finding::State::good, fmt::format("built with {}", name), ""};
  return {Finding::State::advice, fmt::format("built without {}", name),
          fmt::format("only its cameras need it: install {}, then build again", package)};
}

}  // namespace

WantedPackages wanted_packages(std::string_view list) {
  WantedPackages wanted;
  std::istringstream lines{std::string(list)};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, mark;
    if (!(words >> name) || name.starts_with('#')) continue;
    (words >> mark && mark == "#test" ? wanted.to_test : wanted.to_run).push_back(name);
  }
  return wanted;
}

std::set<std::string> installed_packages(std::istream& status) {
  std::set<std::string> names;
  std::string name;
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("Package: ")) name = line.substr(9);
    if (line.starts_with("Status: ") && line.ends_with(" ok installed")) names.insert(name);
  }
  return names;
}

std::vector<Finding> check_packages() {
  std::vector<Finding> findings{
      check_camera_library("libfreenect (Kinect v1)", "libfreenect-dev", has_freenect()),
      check_camera_library("OpenNI2", "libopenni2-dev", has_openni2())};
  std::ifstream status(dpkg_status);
  if (!status) {
    findings.push_back({Finding::State::advice, "not a Debian system: packages are not checked",
                        "install the equivalents of the packages in scripts/packages"});
    return findings;
  }
  const auto wanted = wanted_packages(package_list().at("packages"));
  const auto installed = installed_packages(status);
  findings.push_back(check_installed(wanted.to_run, installed, "building and running"));
  findings.push_back(check_installed(wanted.to_test, installed, "testing"));
  return findings;
}

}  // namespace touchtrace::cli
