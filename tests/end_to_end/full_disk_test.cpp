#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "engine/base/files.h"
#include "engine/base/scratch_folder.h"

namespace touchtrace {
namespace {

/// Files are limited to 20 kB, which a shell counts in blocks of 512 bytes.
TEST(FullDisk, IsAnErrorWithAHint) {
  const ScratchFolder folder;
  const std::string path = folder.path();
  const int status = std::system(
      fmt::format("trap '' XFSZ; ulimit -f 40; exec {} import {}/tests/data/hand_pour_bottle "
                  "--depth-scale 1000 --quiet --output {}/a.h5 2>{}/messages",
                  TOUCHTRACE_PROGRAM, TOUCHTRACE_SOURCE_DIR, path, path)
          .c_str());
  ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const std::string messages = read_file(folder.path() / "messages");
  EXPECT_NE(messages.find("File too large\nhint: check free disk space"), std::string::npos)
      << messages;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.h5"));
}

}  // namespace
}  // namespace touchtrace
