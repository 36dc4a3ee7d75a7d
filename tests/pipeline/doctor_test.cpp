#include "pipeline/cli/doctor.h"

#include <gtest/gtest.h>

#include <sstream>

#include "pipeline/cli/packages.h"

namespace touchtrace::cli {
namespace {

TEST(Doctor, ReadsPackageListByPurpose) {
  const auto wanted = wanted_packages("# a comment\ncmake\n\npocl-opencl-icd\noclgrind #test\n");
  EXPECT_EQ(wanted.to_run, (std::vector<std::string>{"cmake", "pocl-opencl-icd"}));
  EXPECT_EQ(wanted.to_test, std::vector<std::string>{"oclgrind"});
  EXPECT_FALSE(wanted_packages(package_list().at("packages")).to_run.empty());
}

TEST(Doctor, IgnoresPackagesThatAreNotFullyInstalled) {
  std::istringstream status(
      "Package: cmake\nStatus: install ok installed\nVersion: 3.25\n\n"
      "Package: gone\nStatus: deinstall ok config-files\n\n"
      "Package: half\nStatus: install ok half-installed\n\n"
      "Package: held\nVersion: 1\nStatus: hold ok installed\n");
  EXPECT_EQ(installed_packages(status), (std::set<std::string>{"cmake", "held"}));
}

TEST(Doctor, HintsOnlyForFindingsThatAreNotGood) {
  for (const auto& check : {check_packages, check_disk, check_usb})
    for (const auto& finding : check()) {
      EXPECT_FALSE(finding.what.empty());
      EXPECT_EQ(finding.hint.empty(), finding.state == Finding::State::good) << finding.what;
    }
}

}  // namespace
}  // namespace touchtrace::cli
