#include "tests/pipeline/import_samples.h"

namespace touchtrace {
namespace {

using ImportFolder = Import;

/// Names as programs write them into one folder. `%` is the image's number.
TEST_F(ImportFolder, ReadsColorAndDepthInOneFolder) {
  for (const auto& [color, depth] : {std::pair{"color_%.png", "depth_%.png"},
                                     {"frame-00000%.color.png", "frame-00000%.depth.png"},
                                     {"color_00000%.png", "aligned_depth_to_color_00000%.png"},
                                     {"000000000%.png", "000000000%_depth.png"},
                                     {"image_%.png", "depth_%.png"}}) {
    SCOPED_TRACE(color);
    fs::remove_all(folder_ / "in");
    for (int i = 0; i < import_frames; ++i) {
      const auto name = [&](std::string text) {
        return text.replace(text.find('%'), 1, std::to_string(i));
      };
      add_file("in/" + name(color), encoded(import_color(i)));
      add_file("in/" + name(depth), encoded(import_depth(i, 1000)));
      add_file("in/" + name("mask_%.png"), encoded(import_color(i)));
    }
    expect_samples(import("in", at_rate(30.0)), 1000);
  }
}

TEST_F(ImportFolder, NamesSeriesThatCannotBeToldApart) {
  for (const char* camera : {"rgb_image1", "rgb_image2", "depth1"})
    for (int i = 0; i < import_frames; ++i)
      add_file(fmt::format("in/{}_{}.png", camera, i),
               encoded(camera[0] == 'r' ? import_color(i) : import_depth(i, 1000)));
  expect_rejected("in", "rgb_image1_#.png, rgb_image2_#.png", at_rate(30.0));
}

TEST_F(ImportFolder, ReadsFoldersOfOtherNames) {
  add_images(1000, "in/Frames", "in/depthMatrices");
  add_images(1000, "in/Frames", "in/SegmentedDepth");
  expect_samples(import("in", at_rate(30.0)), 1000);
  add_file("in/depth_raw/0.png", encoded(import_depth(0, 1000)));
  expect_rejected("in", "depthMatrices, depth_raw", at_rate(30.0));
}

/// Frame 1 is missing.
TEST_F(ImportFolder, ReadsTimesAndIntrinsicsOfRecord3d) {
  for (int i = 0; i < import_frames; ++i) {
    const std::string name = std::to_string(i == 0 ? 0 : i + 1) + ".png";
    add_file("in/rgb/" + name, encoded(import_color(i)));
    add_file("in/depth/" + name, encoded(import_depth(i, 1000)));
  }
  add_file("in/metadata.json", R"({"frameTimestamps": [0, 0.1, 0.2, 0.3, 0.5], "w": 8, "h": 6,
                                   "K": [7, 0, 0, 0, 7, 0, 4, 3, 1]})");
  const auto recording = import("in", {}).recording();
  const auto& time_s = recording.camera_times.host_time_s;
  ASSERT_EQ(time_s.size(), 4u);
  EXPECT_NEAR(time_s.back() - time_s.front(), 0.5, 1e-9);
  ASSERT_TRUE(recording.camera.color_camera);
  EXPECT_EQ(recording.camera.color_camera->cx, 4.0);
  add_file("in/metadata.json", R"({"frameTimestamps": [0, 0.1], "author": "somebody"})");
  expect_rejected("in", "have no times", {});
}

TEST_F(ImportFolder, PrefersRegisteredDepth) {
  add_images(500, "in/color");
  add_images(1000, "in/color", "in/aligned_depth_to_color");
  const RecordingReader reader = import("in", at_rate(30.0));
  expect_samples(reader, 1000);
  EXPECT_TRUE(reader.recording().camera.is_registered);
}

TEST_F(ImportFolder, NamesSourcesInsideAFolder) {
  add_file("in/README.md", "a repository");
  expect_rejected("in", "give one of: TUM RGB-D folder");
  write_import_tum(folder_ / "in" / "second");
  write_import_tum(folder_ / "in" / "first");
  expect_rejected("in", "first, ");
  fs::rename(folder_ / "in" / "first", folder_ / "in" / "images1");
  fs::rename(folder_ / "in" / "second", folder_ / "in" / "images2");
  expect_rejected("in", "images1, ");
}

/// counts_per_m: what the file states, with images whose depth is 1 m.
TEST_F(ImportFolder, ReadsIntrinsicsAndDepthScales) {
  struct Case {
    const char *file, *text;
    int counts_per_m;
  };
  for (const Case& c :
       {Case{"camera_intrinsic.json",
             R"({"width": 8, "height": 6, "intrinsic_matrix": [7, 0, 0, 0, 7, 0, 4, 3, 1]})", 1000},
        {"camera.json",
         R"({"fx": 7, "fy": 7, "cx": 4, "cy": 3, "width": 8, "height": 6, "depth_scale": 0.1})",
         10000},
        {"scene_camera.json",
         R"({"0": {"cam_K": [7, 0, 4, 0, 7, 3, 0, 0, 1], "depth_scale": 0.25}, "1": {}})", 4000},
        {"intrinsics.json", R"({"fx": 7, "fy": 7, "ppx": 4, "ppy": 3, "depth_scale": 0.0002})",
         5000},
        {"cam.json", R"({"px": 7, "py": 7, "u0": 4, "v0": 3})", 1000},  // ViSP
        {"cam_intrinsics.json", R"({"fx": 7, "fy": 7, "cx": 4, "cy": 3, "depth_scale": 2000})",
         2000},
        {"intrinsics.yaml",
         "depth: {fx: 9, fy: 9, ppx: 4, ppy: 3}\ncolor: {fx: 7, fy: 7, ppx: 4, ppy: 3}\n", 1000},
        {"camera.yaml", "%YAML:1.0\nCamera.fx: 7\nCamera.fy: 7\nCamera.cx: 4\nCamera.cy: 3\n",
         1000},
        {"camera_matrix.yml",
         "%YAML:1.0\nK: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n"
         "  data: [7, 0, 4, 0, 7, 3, 0, 0, 1]\n",
         1000},
        {"intrinsics.yml",
         "%YAML:1.0\nM1: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n"
         "  data: [7, 0, 4, 0, 7, 3, 0, 0, 1]\n"
         "D1: !!opencv-matrix\n  rows: 1\n  cols: 8\n  dt: d\n"
         "  data: [0.1, 0.2, 0, 0, 0, 0, 0, 0.7]\n"
         "M2: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n"
         "  data: [9, 0, 4, 0, 9, 3, 0, 0, 1]\n",
         1000},
        {"intrinsic_color.txt", "7 0 4 0\n0 7 3 0\n0 0 1 0\n0 0 0 1\n", 1000},
        {"camera_matrix.csv", "7, 0, 4\n0, 7, 3\n0, 0, 1\n", 1000}}) {
    SCOPED_TRACE(c.file);
    fs::remove_all(folder_ / "in");
    add_images(c.counts_per_m);
    add_file(std::string("in/") + c.file, c.text);
    const RecordingReader reader = import("in", at_rate(30.0));
    expect_samples(reader, c.counts_per_m);
    const auto& camera = reader.recording().camera.color_camera;
    ASSERT_TRUE(camera);
    EXPECT_EQ(camera->fx, 7.0);
    EXPECT_EQ(camera->cx, 4.0);
    EXPECT_EQ(camera->cy, 3.0);
  }
}

TEST_F(ImportFolder, LensDistortionHasManyNames) {
  add_images();
  for (const char* distortion :
       {R"("dist_coeffs": [[0.1, 0.2, 0.01, 0.02, 0.3]])",
        R"("dist_coeff": [0.1, 0.2, 0.01, 0.02, 0.3])",
        R"("distortion_coefficients": {"data": [0.1, 0.2, 0.01, 0.02, 0.3]})",
        R"("k1": 0.1, "k2": 0.2, "p1": 0.01, "p2": 0.02, "k3": 0.3)"}) {
    add_file("in/intrinsics.json",
             fmt::format(R"({{"fx": 7, "fy": 7, "cx": 4, "cy": 3, {}}})", distortion));
    const auto camera = import("in", at_rate(30.0)).recording().camera.color_camera;
    ASSERT_TRUE(camera);
    EXPECT_EQ(camera->distortion[4], 0.3) << distortion;
  }
}

TEST_F(ImportFolder, NamesIntrinsicsThatItCannotRead) {
  add_images();
  for (const char* text : {"lens: {focal_length: 7}\n", "7\n", "a: [\n", "fx: {a: 1}\nfy: 1\n",
                           "depth: {fx: 7, fy: 7, cx: 4, cy: 3}\n"}) {
    SCOPED_TRACE(text);
    add_file("in/camera.yaml", text);
    const std::string message = expect_rejected("in", "camera.yaml", at_rate(30.0), ExitCode::data);
    EXPECT_EQ(message.find("json.exception"), std::string::npos) << message;
  }
}

TEST_F(ImportFolder, NamesCalibrationsInXml) {
  add_images();
  add_file("camera.xml", "<?xml version=\"1.0\"?>\n<opencv_storage/>\n");
  ImportOptions options = at_rate(30.0);
  options.camera.camera_info = (folder_ / "camera.xml").string();
  expect_rejected("in", "camera.xml is XML, which is not read", options);
}

TEST_F(ImportFolder, SaysHowToConvertListsAndOtherFiles) {
  add_file("in/depth/0.png", encoded(import_depth(0, 1000)));
  add_file("in/rgb.mp4", "a video");
  expect_rejected("in", "ffmpeg -i " + (folder_ / "in" / "rgb.mp4").string(), at_rate(30.0));
  add_file("in/rgb/0.png", encoded(import_color(0)));
  add_file("in/associations.txt", "0.5 rgb/0.png 0.5 depth/0.png\n");
  expect_rejected("in", "awk '{print $3, $4}' associations.txt > depth.txt");
  fs::remove(folder_ / "in" / "depth" / "0.png");
  add_file("in/depth/0.exr", "v/1");
  expect_rejected("in", "OpenEXR, which is not read", at_rate(30.0));
}

TEST_F(ImportFolder, WarnsOfDistantScenes) {
  add_images(9000);  // of 0.1 mm
  ImportOptions options = at_rate(30.0);
  import("in", options);
  EXPECT_TRUE(warns_of("the median depth is 9 m")) << warnings_;
  EXPECT_TRUE(warns_of("10000 (median 0.90 m)")) << warnings_;
  options.camera.depth_scale = 1000.0;
  import("in", options);
  EXPECT_FALSE(warns_of("median depth")) << warnings_;
}

TEST_F(ImportFolder, RefusesEqualTimes) {
  add_images();
  add_file("in/times.txt", "5\n5\n5\n5\n");
  expect_rejected("in", "all 4 colour images have the time 5 s");
}

const fs::path matlab_files = fs::path(TOUCHTRACE_SOURCE_DIR) / "tests" / "data" / "matlab";

/// Files of scipy.io.savemat. The image is import_depth(3).
TEST_F(ImportFolder, ReadsMatlabFiles) {
  for (const auto& [name, counts_per_m] :
       {std::pair{"uint16_compressed", 1000}, {"double_counts", 1000}, {"single_metres", 4000}}) {
    SCOPED_TRACE(name);
    fs::remove_all(folder_ / "in");
    add_file("in/rgb_3.png", encoded(import_color(3)));
    fs::copy_file(matlab_files / (std::string(name) + ".mat"), folder_ / "in" / "rgb_3.mat");
    const RgbdFrame frame = import("in", at_rate(30.0)).read_camera_frame(0);
    EXPECT_EQ(frame.depth[0], counts_per_m);
    EXPECT_EQ(frame.depth[2 * import_width + 3], counts_per_m + 15 * counts_per_m / 1000);
  }
  add_file("in/rgb_3.mat", "MATLAB 7.3 MAT-file" + std::string(200, ' '));
  expect_rejected("in", "save it with -v7", at_rate(30.0));
}

TEST_F(ImportFolder, SurvivesDamagedMatlabFiles) {
  add_file("in/rgb_3.png", encoded(import_color(3)));
  for (const char* name : {"uint16_compressed.mat", "double_counts.mat"})
    expect_damage_survived("in/rgb_3.mat", read_file(matlab_files / name, 1u << 20), 100,
                           at_rate(30.0), 128);
}

}  // namespace
}  // namespace touchtrace
