#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "pipeline/cli/doctor.h"
#include "pipeline/cli/packages.h"

namespace touchtrace::cli {
namespace {

constexpr const char* dpkg_status = "/var/lib/dpkg/status";

Finding look_for(const std::vector<std::string>& wanted, const std::set<std::string>& installed,
                 const std::string& purpose) {
  std::vector<std::string> missing;
  std::ranges::copy_if(wanted, std::back_inserter(missing),
                       [&](const auto& name) { return !installed.contains(name); });
  if (missing.empty())
    return {Finding::State::good, fmt::format("all {} packages {}", wanted.size(), purpose), ""};
  return {Finding::State::advice,
          fmt::format("packages {} are missing: {}", purpose, fmt::join(missing, " ")),
          fmt::format("sudo apt-get install {}", fmt::join(missing, " "))};
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
  std::ifstream status(dpkg_status);
  if (!status)
    return {{Finding::State::advice, "this is no Debian: its packages are not checked",
             "install what scripts/packages names as your system names it"}};
  const auto wanted = wanted_packages(package_list().at("packages"));
  const auto installed = installed_packages(status);
  return {look_for(wanted.to_run, installed, "to build and to run"),
          look_for(wanted.to_test, installed, "to test")};
}

}  // namespace touchtrace::cli
