#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "calib/rgbd/rotation.h"
#include "calib/rig/rig.h"
#include "calib/rig/rig_comparison.h"
#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/scratch_folder.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

/// Three cameras with lenses that kalibr knows.
RigCalibration sample_rig() {
  RigCalibration rig;
  for (int i = 0; i < 3; ++i) {
    rig.names.push_back("c" + std::to_string(i));
    Camera& camera = rig.cameras.emplace_back().color;
    camera.width = 640, camera.height = 480;
    camera.lens = Radtan4{};
    camera.set_parameters({500.0 + i, 501.0, 320.0, 240.0, -0.2, 0.1, 0.001, 0.002});
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = rotation_matrix(i * Eigen::Vector3d(0.1, -0.2, 0.3));
    pose.translation() = i * Eigen::Vector3d(-0.1, 0.02, 0.03);
    rig.camera_from_rig.push_back(pose);
  }
  rig.parameters = {"c1_from_c0.rx", "c1_from_c0.ry", "c1_from_c0.rz",
                    "c1_from_c0.tx", "c1_from_c0.ty", "c1_from_c0.tz"};
  rig.covariance = 4.0 * Eigen::MatrixXd::Identity(6, 6);
  rig.details = {{"verdict", "GOOD"}};
  return rig;
}

void expect_same_cameras(const RigCalibration& read, const RigCalibration& written) {
  ASSERT_EQ(read.cameras.size(), written.cameras.size());
  for (std::size_t i = 0; i < read.cameras.size(); ++i) {
    EXPECT_EQ(read.cameras[i].color.parameters(), written.cameras[i].color.parameters());
    EXPECT_TRUE(read.camera_from_rig[i].isApprox(written.camera_from_rig[i], 1e-12));
  }
}

TEST(RigFile, IsReadBack) {
  const ScratchFolder folder;
  const RigCalibration rig = sample_rig();
  write_rig(folder.path() / "rig", rig, false);
  const RigCalibration read = read_rig(folder.path() / "rig");
  expect_same_cameras(read, rig);
  EXPECT_EQ(read.names, rig.names);
  EXPECT_EQ(read.parameters, rig.parameters);
  EXPECT_TRUE(read.covariance == rig.covariance);
  EXPECT_DOUBLE_EQ(relative_pose(read, 1).baseline_sigma_m, 2.0);
  EXPECT_TRUE(fs::exists(folder.path() / "rig/c1/calibration.json"));
}

TEST(RigFile, CamchainOfThreeCamerasIsReadBack) {
  const ScratchFolder folder;
  const RigCalibration rig = sample_rig();
  write_rig(folder.path() / "rig", rig, false);
  const RigCalibration read = read_rig(folder.path() / "rig/camchain.yaml");
  expect_same_cameras(read, rig);
  EXPECT_TRUE(std::isnan(relative_pose(read, 1).baseline_sigma_m));
}

TEST(RigFile, ComparisonCountsStandardDeviations) {
  const RigCalibration rig = sample_rig();
  RigCalibration moved = rig;
  moved.camera_from_rig[1].translation().x() += 12.0;
  moved.parameters.clear();  // exact
  RigCalibration pair = rig;
  for (auto* r : {&pair, &moved}) r->cameras.pop_back(), r->camera_from_rig.pop_back();
  const auto differences = compare(pair, moved);
  ASSERT_EQ(differences.size(), 1u);
  EXPECT_NEAR(differences[0].rms_sigmas, 6.0 / std::sqrt(6.0), 1e-9);  // sigma: 2 m
  EXPECT_FALSE(differences[0].agrees());
  EXPECT_TRUE(compare(pair, pair)[0].agrees());
  EXPECT_THROW(compare(rig, pair), Error);
  EXPECT_THROW(compare(moved, moved), Error);
}

TEST(RigFile, IsNotOverwritten) {
  const ScratchFolder folder;
  write_file(folder.path() / "rig/c2/calibration.json", "precious", false);
  EXPECT_THROW(write_rig(folder.path() / "rig", sample_rig(), false), Error);
  EXPECT_FALSE(fs::exists(folder.path() / "rig/rig.json"));
  EXPECT_FALSE(fs::exists(folder.path() / "rig/c0/calibration.json"));
}

TEST(RigFile, FaultsAreErrors) {
  const ScratchFolder folder;
  write_rig(folder.path() / "rig", sample_rig(), false);
  const std::string good = read_file(folder.path() / "rig/rig.json");
  const auto reads = [&](const std::string& name, const std::string& text) {
    write_file(folder.path() / name, text, true);
    return [path = folder.path() / name] { read_rig(path); };
  };
  EXPECT_THROW(read_rig(folder.path() / "missing"), Error);
  EXPECT_THROW(reads("a.json", "{}")(), Error);
  EXPECT_THROW(reads("a.json", good.substr(0, good.size() / 2))(), Error);
  EXPECT_THROW(reads("a.json", R"({"schema": "touchtrace/rig/1", "cameras": 3})")(), Error);
  EXPECT_THROW(reads("a.yaml", "cam1: {}")(), Error);
  RigCalibration short_covariance = sample_rig();
  short_covariance.parameters.resize(3);
  short_covariance.covariance = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_TRUE(std::isnan(relative_pose(short_covariance, 1).baseline_sigma_m));
  std::string chain = read_file(folder.path() / "rig/camchain.yaml");
  chain.erase(chain.rfind("T_cn_cnm1"), 9);
  EXPECT_THROW(reads("a.yaml", chain)(), Error);
}

}  // namespace
}  // namespace touchtrace
