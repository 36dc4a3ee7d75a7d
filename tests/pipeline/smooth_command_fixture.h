#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "engine/base/files.h"
#include "engine/base/random.h"
#include "engine/base/text.h"
#include "pipeline/cli/commands.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/verify/calib/synthetic_track.h"

/// Runs `touchtrace smooth` on files in a temporary folder.
namespace touchtrace::smooth_command {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::put, testing::TemporaryFolder;

inline int run(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"touchtrace", "smooth", "--quiet"});
  std::vector<const char*> argv;
  for (const auto& argument : arguments) argv.push_back(argument.c_str());
  return cli::run_command_line(cli::touchtrace_program(), static_cast<int>(argv.size()),
                               argv.data());
}

/// Columns of a CSV file by name, as text.
inline std::map<std::string, std::vector<std::string>> columns_of(const fs::path& file) {
  std::istringstream lines(read_file(file));
  std::string line;
  std::getline(lines, line);
  const auto names = split_text(line, ',');
  std::map<std::string, std::vector<std::string>> columns;
  while (std::getline(lines, line)) {
    const auto fields = split_text(line, ',');
    EXPECT_EQ(fields.size(), names.size());
    for (std::size_t i = 0; i < names.size(); ++i) columns[names[i]].push_back(fields[i]);
  }
  return columns;
}

inline std::vector<double> numbers(const std::vector<std::string>& texts) {
  std::vector<double> values;
  for (const auto& text : texts) values.push_back(std::stod(text));
  return values;
}

inline std::string csv(const Track& track) {
  std::string text = "time_s,x_m,y_m,z_m\n";
  for (const auto& [time_s, p, sigma_m] : track)
    text += fmt::format("{},{},{},{}\n", time_s, p.x(), p.y(), p.z());
  return text;
}

inline constexpr double amplitude_m = 0.1, rad_per_s = 2.0 * std::numbers::pi;

/// Sine along x at 100 Hz with white errors of 1 mm, at rest along y and z.
inline Track sine(double seconds, std::uint64_t seed) {
  RandomStream random(seed, "sine");
  Track track;
  for (int i = 0; i <= 100 * seconds; ++i) {
    const double t = 0.01 * i;
    Eigen::Vector3d error;
    for (double& e : error) e = random.normal(0.0, 1e-3);
    track.push_back({t, error + amplitude_m * std::sin(rad_per_s * t) * Eigen::Vector3d::UnitX(),
                     Eigen::Vector3d::Constant(1e-3)});
  }
  return track;
}

class SmoothCommand : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  json summary(const std::string& output = "out") const {
    return json::parse(read_file(folder_ / (output + "/smooth.json")));
  }

  TemporaryFolder folder_;
};

}  // namespace touchtrace::smooth_command
