// Includes run one way (CONTRIBUTING.md, "Structure").
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

/// Modules that each module may include, besides itself.
const std::map<std::string, std::set<std::string>>& allowed() {
  static const std::set<std::string> shared{"engine/base", "pipeline/recording",
                                            "pipeline/dataset"};
  const auto with = [](std::set<std::string> modules, std::initializer_list<std::string> more) {
    modules.insert(more);
    return modules;
  };
  const auto scene = [&](std::initializer_list<const char*> modules) {
    std::set<std::string> all{"engine/base", "pipeline/recording"};
    for (const char* module : modules) all.insert(std::string("pipeline/scene/") + module);
    return all;
  };
  static const auto sources = with(shared, {"pipeline/acquire", "pipeline/acquire/import/formats",
                                            "pipeline/acquire/import/source"});
  static const std::map<std::string, std::set<std::string>> modules{
      {"engine/base", {}},
      {"engine/cl", {"engine/base"}},
      {"engine/ops", {"engine/base", "engine/cl"}},
      {"engine/check", {"engine/base", "engine/cl", "engine/ops"}},
      {"engine/model", {"engine/base", "engine/cl", "engine/ops"}},
      {"engine/train", {"engine/base", "engine/cl", "engine/ops", "engine/check", "engine/model"}},
      {"calib/matrix", {}},
      {"calib/camera", {"engine/base"}},
      {"calib/board", {"engine/base", "calib/matrix", "calib/camera"}},
      {"calib/rgbd", {"engine/base", "calib/matrix", "calib/camera", "calib/board"}},
      {"calib/rig", {"engine/base", "calib/matrix", "calib/camera", "calib/board", "calib/rgbd"}},
      {"calib/smooth", {"engine/base"}},
      {"pipeline/recording", {"engine/base", "calib/camera"}},
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
      {"pipeline/acquire",
       with(shared, {"calib/board", "calib/camera", "calib/rgbd", "calib/smooth"})},
      {"pipeline/acquire/import/formats", {"engine/base"}},
      {"pipeline/acquire/import/source", {"engine/base", "calib/camera", "pipeline/acquire"}},
      {"pipeline/acquire/import/bags", with(sources, {"calib/rgbd"})},
      {"pipeline/acquire/import/images", sources},
      {"pipeline/acquire/import/gloves", sources},
      {"pipeline/acquire/import",
       with(sources, {"calib/camera", "calib/rgbd", "pipeline/acquire/glove",
                      "pipeline/acquire/import/images", "pipeline/acquire/import/gloves"})},
      {"pipeline/acquire/glove", {"engine/base", "pipeline/recording"}},
      {"pipeline/acquire/transport", {"engine/base"}},
      {"pipeline/acquire/record",
       {"engine/base", "calib/rgbd", "pipeline/recording", "pipeline/acquire/glove",
        "pipeline/acquire/transport", "pipeline/acquire/import"}},
      {"pipeline/web", {"engine/base"}},
      {"pipeline/mark", with(shared, {"pipeline/web"})},
      {"pipeline/live", {"engine/base", "pipeline/web"}},
      {"pipeline/label/observe", with(shared, {"calib/camera", "calib/rgbd"})},
      {"pipeline/label/estimate", with(shared, {"calib/matrix", "calib/camera"})},
      {"pipeline/label/learn", with(shared, {"pipeline/label/observe", "pipeline/label/estimate"})},
      {"pipeline/label/track",
       with(shared, {"calib/board", "calib/smooth", "pipeline/label/observe",
                     "pipeline/label/estimate", "pipeline/label/learn"})},
      {"pipeline/label/states", with(shared, {"calib/matrix", "calib/rgbd", "calib/smooth",
                                              "pipeline/label/learn", "pipeline/label/track"})},
      {"pipeline/label/preview",
       with(shared, {"calib/camera", "calib/rgbd", "pipeline/label/states"})},
      {"pipeline/label",
       with(shared, {"calib/rgbd", "pipeline/label/observe", "pipeline/label/learn",
                     "pipeline/label/track", "pipeline/label/states", "pipeline/label/preview"})},
      {"pipeline/report", shared},
      {"pipeline/sweep", {"engine/base", "pipeline/recording"}},
      {"pipeline/export",
       with(shared, {"calib/camera", "engine/model", "engine/train", "pipeline/study"})},
  };
  return modules;
}

/// Modules that may include any other one of the product.
const std::set<std::string> composers{"pipeline/study", "pipeline/cli", "pipeline/cli/main"};

/// The folder of a path "engine/base/files.h".
std::string module_of(const std::string& path) { return fs::path(path).parent_path(); }

std::vector<std::string> included_modules(const fs::path& file) {
  static const std::regex include(
      R"re(^\s*#\s*include\s*"((?:engine|calib|pipeline|tests)/[^"]+)")re");
  std::vector<std::string> modules;
  std::ifstream stream(file);
  std::smatch match;
  for (std::string line; std::getline(stream, line);)
    if (std::regex_search(line, match, include)) modules.push_back(module_of(match[1]));
  return modules;
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

TEST(Structure, IncludesRunOneWay) {
  int includes = 0;
  for_each_source([&](const fs::path& file, const std::string& name) {
    const std::string module = module_of(name);
    if (composers.contains(module)) return;
    ASSERT_TRUE(allowed().contains(module))
        << module << " is a new module: give it a row in this test";
    for (const auto& other : included_modules(file)) {
      ++includes;
      EXPECT_TRUE(other == module || allowed().at(module).contains(other))
          << name << " must not include " << other;
    }
  });
  EXPECT_GT(includes, 100) << "the includes were not found";
}

TEST(Structure, ProductIncludesNothingOfTests) {
  for_each_source([&](const fs::path& file, const std::string& name) {
    for (const auto& other : included_modules(file))
      EXPECT_FALSE(other.starts_with("tests")) << name << " includes " << other;
  });
}

TEST(Structure, OnlyTheTopLayerIncludesItself) {
  for_each_source([&](const fs::path& file, const std::string& name) {
    if (name.starts_with("pipeline/cli/")) return;
    for (const auto& other : included_modules(file)) EXPECT_NE(other, "pipeline/cli") << name;
  });
}

TEST(Structure, NoSourceIsEmpty) {
  for_each_source([&](const fs::path& file, const std::string& name) {
    EXPECT_GT(fs::file_size(file), 0u) << name;
  });
}

TEST(Structure, CalibrationDoesNotUseOpenCl) {
  for_each_source([&](const fs::path& file, const std::string& name) {
    if (!name.starts_with("calib/")) return;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);)
      EXPECT_EQ(line.find("#include <CL/"), std::string::npos) << name;
  });
}

}  // namespace
