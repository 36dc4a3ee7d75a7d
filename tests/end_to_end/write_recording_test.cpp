#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

using touchtrace::testing::run_program;

TEST(WriteRecording, ExampleWritesAFileThatEachCommandButCalibrateCanUse) {
  const auto folder = touchtrace::testing::scratch_folder();
  std::filesystem::create_directories(folder);
  const std::string file = (folder / "a.h5").string();
  const std::string script = std::string(TOUCHTRACE_SOURCE_DIR) + "/scripts/write_recording.py ";
  ASSERT_EQ(std::system(("/usr/bin/python3 " + script + file).c_str()), 0);
  const auto checked = run_program("check --json --for label " + file);
  ASSERT_EQ(checked.exit_code, 0) << checked.output;
  const auto json = nlohmann::json::parse(checked.output);
  EXPECT_TRUE(json["faults"].empty()) << checked.output;
  EXPECT_TRUE(json["warnings"].empty()) << checked.output;
  EXPECT_TRUE(json["lacks"]["train"].empty()) << checked.output;
  const std::string labels = (folder / "a.labels.h5").string(),
                    labels_script =
                        std::string(TOUCHTRACE_SOURCE_DIR) + "/scripts/write_labels.py ";
  ASSERT_EQ(std::system(("/usr/bin/python3 " + labels_script + file + " " + labels).c_str()), 0);
  EXPECT_EQ(run_program("check " + labels).exit_code, 0);
  const auto trained = run_program("train --recording " + file +
                                   " --updates 1 --steps 5 --window 3 --without-touch --output " +
                                   (folder / "a.safetensors").string());
  EXPECT_EQ(trained.exit_code, 0) << trained.output;
  // without /clips
  ASSERT_EQ(std::system(("/usr/bin/python3 -c \"import h5py; f = h5py.File('" + file +
                         "', 'a'); del f['clips']\"")
                            .c_str()),
            0);
  ASSERT_EQ(
      std::system(
          ("/usr/bin/python3 " + labels_script + "--overwrite " + file + " " + labels).c_str()),
      0);
  const auto whole = run_program("train --recording " + file +
                                 " --updates 1 --steps 5 --window 3 --without-touch --output " +
                                 (folder / "b.safetensors").string());
  EXPECT_EQ(whole.exit_code, 0) << whole.output;
  std::filesystem::remove_all(folder);
}

TEST(Check, PrintsTheFaultsOfAFileThatCannotBeReadAsJson) {
  const auto folder = touchtrace::testing::scratch_folder();
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "a.h5") << "not HDF5";
  const auto checked = run_program("check --json " + (folder / "a.h5").string());
  EXPECT_EQ(checked.exit_code, 3);
  const auto begin = checked.output.find('{'), end = checked.output.rfind('}');
  ASSERT_TRUE(begin < end) << checked.output;
  const auto json =
      nlohmann::json::parse(checked.output.substr(begin, end + 1 - begin), nullptr, false);
  ASSERT_TRUE(json.is_object()) << checked.output;
  EXPECT_EQ(json.at("faults").size(), 1u);
  EXPECT_EQ(json.at("good"), false);
  std::filesystem::remove_all(folder);
}

TEST(Plan, RefusesUnknownObjects) {
  EXPECT_EQ(run_program("plan --object ball").exit_code, 0);
  const auto refused = run_program("plan --object nosuch");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.output.find("nosuch"), std::string::npos) << refused.output;
}

}  // namespace
