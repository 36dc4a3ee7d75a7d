// scripts/fresh_machine deletes only folders that it made.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::testing::ProgramResult;
using touchtrace::testing::run_program;

class FreshMachine : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(scratch_);
    fs::create_directories(machine_);
    fs::create_directories(scratch_ / "stubs");
    add_stub("id", "echo 0");
    add_stub("debootstrap", "exit 9");  // ends the script where it would install a system
  }
  void TearDown() override { fs::remove_all(scratch_); }

  void add_stub(const std::string& name, const std::string& body) const {
    const auto path = scratch_ / "stubs" / name;
    std::ofstream(path) << "#!/bin/sh\n" << body << "\n";
    fs::permissions(path, fs::perms::owner_all);
  }
  ProgramResult run(const fs::path& folder) const {
    return run_program("", "bash -c 'PATH=" + (scratch_ / "stubs").string() +
                               ":$PATH " TOUCHTRACE_SOURCE_DIR "/scripts/fresh_machine " +
                               folder.string() + "' ");
  }

  const fs::path scratch_ = touchtrace::testing::scratch_folder(), machine_ = scratch_ / "machine";
};

TEST_F(FreshMachine, RefusesFoldersThatItDidNotMake) {
  std::ofstream(machine_ / "precious") << "x";
  fs::create_directory_symlink(machine_, scratch_ / "link");
  for (const auto& folder : {machine_, scratch_ / "link", machine_ / "precious"}) {
    const auto result = run(folder);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    EXPECT_NE(result.output.find("hint: choose an absent or empty folder"), std::string::npos)
        << result.output;
    EXPECT_TRUE(fs::exists(machine_ / "precious"));
  }
}

TEST_F(FreshMachine, ReplacesAnEmptyOneAndItsOwn) {
  EXPECT_EQ(run(machine_).exit_code, 9);  // empty
  std::ofstream(machine_ / "old") << "x";
  EXPECT_EQ(run(machine_).exit_code, 9);  // has the marker
  EXPECT_FALSE(fs::exists(machine_ / "old"));
  EXPECT_EQ(run(scratch_ / "absent").exit_code, 9);
  EXPECT_TRUE(fs::exists(scratch_ / "absent/.made_by_touchtrace_fresh_machine"));
}

}  // namespace
