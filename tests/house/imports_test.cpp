// The house is held up by its imports: they run one way (CONTRIBUTING.md, "The house").
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path source_dir = TOUCHTRACE_SOURCE_DIR;

/// What each room may include beside itself.
const std::map<std::string, std::set<std::string>>& allowed() {
  static const std::set<std::string> shared{"engine/base", "pipeline/recording",
                                            "pipeline/dataset"};
  const auto with = [](std::set<std::string> rooms, std::initializer_list<std::string> more) {
    rooms.insert(more);
    return rooms;
  };
  const auto scene = [&](std::initializer_list<const char*> rooms) {
    std::set<std::string> all{"engine/base", "pipeline/recording"};
    for (const char* room : rooms) all.insert(std::string("pipeline/scene/") + room);
    return all;
  };
  static const std::map<std::string, std::set<std::string>> rooms{
      {"engine/base", {}},
      {"engine/cl", {"engine/base"}},
      {"engine/ops", {"engine/base", "engine/cl"}},
      {"engine/model", {"engine/base", "engine/cl", "engine/ops"}},
      {"engine/train", {"engine/base", "engine/cl", "engine/ops", "engine/model"}},
      {"calib/camera", {"engine/base"}},
      {"calib/board", {"engine/base", "calib/camera"}},
      {"calib/rgbd", {"engine/base", "calib/camera", "calib/board"}},
      {"calib/smooth", {"engine/base"}},
      {"pipeline/recording", {"engine/base"}},
      {"pipeline/dataset", {"engine/base", "pipeline/recording"}},
      {"pipeline/scene/objects", {"engine/base"}},
      {"pipeline/scene/base", scene({"objects"})},
      {"pipeline/scene/physics", scene({"objects", "base"})},
      {"pipeline/scene/glove", scene({"objects", "base", "physics"})},
      {"pipeline/scene/person", scene({"objects", "base", "physics", "glove"})},
      {"pipeline/scene/camera",
       with(scene({"objects", "base", "physics", "person"}), {"engine/cl", "calib/camera"})},
      {"pipeline/scene/simulate",
       with(scene({"objects", "base", "glove", "person", "camera"}), {"engine/cl"})},
      {"pipeline/scene/laboratory",
       with(scene({"objects", "base", "physics", "glove", "person", "camera", "simulate"}),
            {"engine/cl"})},
      {"pipeline/acquire", with(shared, {"calib/board", "calib/camera", "calib/rgbd"})},
      {"pipeline/label", with(shared, {"calib/camera", "calib/rgbd", "calib/smooth"})},
      {"pipeline/report", shared},
  };
  return rooms;
}

/// Rooms that compose the others.
const std::set<std::string> composers{"pipeline/study", "pipeline/cli", "pipeline/cli/main"};

/// The folder of a path "engine/base/files.h".
std::string room_of(const std::string& path) { return fs::path(path).parent_path(); }

std::vector<std::string> included_rooms(const fs::path& file) {
  static const std::regex include(R"re(^\s*#\s*include\s*"((?:engine|calib|pipeline)/[^"]+)")re");
  std::vector<std::string> rooms;
  std::ifstream stream(file);
  std::smatch match;
  for (std::string line; std::getline(stream, line);)
    if (std::regex_search(line, match, include)) rooms.push_back(room_of(match[1]));
  return rooms;
}

template <class Visit>
void for_each_source(Visit visit) {
  for (const char* top : {"engine", "calib", "pipeline"})
    for (const auto& entry : fs::recursive_directory_iterator(source_dir / top)) {
      const auto extension = entry.path().extension();
      if (extension == ".h" || extension == ".cpp")
        visit(entry.path(), fs::relative(entry.path(), source_dir).string());
    }
}

TEST(House, ImportsRunOneWay) {
  int includes = 0;
  for_each_source([&](const fs::path& file, const std::string& name) {
    const std::string room = room_of(name);
    if (composers.contains(room)) return;
    ASSERT_TRUE(allowed().contains(room)) << room << " is a new room: give it a row in this test";
    for (const auto& other : included_rooms(file)) {
      ++includes;
      EXPECT_TRUE(other == room || allowed().at(room).contains(other))
          << name << " must not include " << other;
    }
  });
  EXPECT_GT(includes, 100) << "the includes were not found";
}

TEST(House, OnlyTheRoofIncludesTheRoof) {
  for_each_source([&](const fs::path& file, const std::string& name) {
    if (name.starts_with("pipeline/cli/")) return;
    for (const auto& other : included_rooms(file)) EXPECT_NE(other, "pipeline/cli") << name;
  });
}

TEST(House, CalibrationKnowsNoOpenCl) {
  for_each_source([&](const fs::path& file, const std::string& name) {
    if (!name.starts_with("calib/")) return;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);)
      EXPECT_EQ(line.find("#include <CL/"), std::string::npos) << name;
  });
}

}  // namespace
