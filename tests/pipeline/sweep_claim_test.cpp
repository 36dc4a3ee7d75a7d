#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "pipeline/sweep/claim.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;
using touchtrace::sweep::Claims;

class SweepClaim : public ::testing::Test {
 protected:
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_ = touchtrace::testing::scratch_folder();
};

TEST_F(SweepClaim, OneProcessHasACell) {
  Claims first, second;
  auto claim = first.take(folder_);
  ASSERT_TRUE(claim);
  EXPECT_FALSE(second.take(folder_));
  claim.reset();
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_TRUE(second.take(folder_));
}

TEST_F(SweepClaim, ClaimsOfEndedProcessesAreTakenOver) {
  const pid_t child = fork();
  if (child == 0) {
    Claims claims;
    const auto claim = claims.take(folder_);
    _exit(claim ? 0 : 1);  // without its destructor
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  ASSERT_TRUE(fs::exists(folder_ / "claim.0"));
  Claims claims, others;
  auto claim = claims.take(folder_);
  ASSERT_TRUE(claim);
  EXPECT_FALSE(others.take(folder_));
  claim.reset();
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SweepClaim, ClaimsOfOtherMachinesAreTakenOverWhenNoLongerRenewed) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "claim.0") << "elsewhere/pid:[1] 1\n";
  Claims::Time time;
  Claims claims(60.0, [&] { return time; });
  EXPECT_FALSE(claims.take(folder_));
  time += std::chrono::seconds(59);
  fs::last_write_time(folder_ / "claim.0", fs::file_time_type::clock::now());
  EXPECT_FALSE(claims.take(folder_)) << "renewed";
  time += std::chrono::seconds(59);
  EXPECT_FALSE(claims.take(folder_));
  time += std::chrono::seconds(1);
  EXPECT_TRUE(claims.take(folder_));
}

}  // namespace
