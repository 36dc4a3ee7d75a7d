// Faulty OpenCL drivers (tests/support/icd), installed next to PoCL or alone.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::testing::ProgramResult;
using touchtrace::testing::run_program;

class BadDriver : public ::testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "vendors");
    std::ofstream(folder_ / "vendors/faulty.icd") << FAULTY_ICD << "\n";
    std::ofstream(folder_ / "vendors/pocl.icd") << "libpocl.so.2\n";
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  ProgramResult run_with_both_drivers(const char* fault, const std::string& arguments) const {
    return run_program(arguments,
                       "OCL_ICD_VENDORS=" + at("vendors") + " FAULTY_ICD=" + fault + " ");
  }

  fs::path folder_ = touchtrace::testing::scratch_folder();
};

TEST_P(BadDriver, IsRejectedWithAMessageAndPoclIsUsed) {
  const auto [fault, message] = GetParam();
  const auto result = run_with_both_drivers(fault, "simulate --minutes 0.01 " + at("scene.h5"));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("is refused"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find(message), std::string::npos) << result.output;
  EXPECT_NE(result.output.find(" instead"), std::string::npos) << result.output;
  EXPECT_TRUE(fs::exists(at("scene.h5")));
}

INSTANTIATE_TEST_SUITE_P(Faults, BadDriver,
                         ::testing::Values(std::pair("lies", "computes wrong values"),
                                           std::pair("crashes", "signal 6"),
                                           std::pair("hangs", "its test hangs"),
                                           std::pair("unlisted", "signal 6")),
                         [](const auto& fault) { return std::string(fault.param.first); });

TEST_F(BadDriver, NamedByTheUserIsAnErrorWithoutFallback) {
  const auto result =
      run_with_both_drivers("lies", "simulate --device Faulty --minutes 0.01 " + at("scene.h5"));
  EXPECT_EQ(result.exit_code, 4) << result.output;
  EXPECT_NE(result.output.find("computes wrong values"), std::string::npos) << result.output;
  EXPECT_FALSE(fs::exists(at("scene.h5")));
}

TEST_F(BadDriver, IsReportedByDoctor) {
  for (const auto& [fault, message] :
       {std::pair("lies", "Faulty 3000: tactile_window computes wrong values"),
        std::pair("crashes", "Faulty 3000: its test ended by signal 6"),
        std::pair("unlisted", "listing the OpenCL devices ended by signal 6")}) {
    const auto result = run_with_both_drivers(fault, "doctor");
    EXPECT_NE(result.output.find(message), std::string::npos) << result.output;
  }
}

TEST_F(BadDriver, WithoutAnotherDriverIsAnError) {
  const auto result =
      run_program("self-test", std::string("FAULTY_ICD=lies OCL_ICD_VENDORS=") + FAULTY_ICD + " ");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_NE(result.output.find("Faulty 3000"), std::string::npos) << result.output;
}

}  // namespace
