#pragma once

#include <cstdlib>

#include "pipeline/acquire/import/glove_import.h"
#include "tests/pipeline/import_samples.h"

namespace touchtrace {

inline constexpr double glove_start_s = 1700000000.0;  // of write_glove_files.py
inline constexpr int rest_frames = 60, taxels = 12;

/// Count of taxel `i` as write_glove_files.py has it.
inline int glove_count(int frame, int i) {
  const int row = i / 3, col = i % 3;
  const bool is_pressed = frame >= rest_frames && frame % 40 < 20;
  return 3000 + 10 * row + col + (7 * frame + col) % 3 - 1 - (is_pressed ? 800 : 0);
}

class ImportGlove : public Import {
 protected:
  void SetUp() override {
    Import::SetUp();
    const std::string command = std::string("/usr/bin/python3 ") + TOUCHTRACE_SOURCE_DIR +
                                "/tests/pipeline/write_glove_files.py " + folder_.path().string();
    ASSERT_EQ(std::system(command.c_str()), 0);
  }
  ImportOptions with_glove(const std::string& name) const {
    ImportOptions options;
    options.glove.file = folder_ / name;
    options.glove.rest_s = 3.0;
    return options;
  }
  static ImportOptions with_layout(ImportOptions options, int rows = 4, int cols = 3) {
    options.glove.layout.rows = rows, options.glove.layout.cols = cols;
    return options;
  }
  /// Options that need no frames at rest.
  ImportOptions alone(const std::string& name, int rows, int cols) const {
    ImportOptions options = with_layout(with_glove(name), rows, cols);
    options.glove.polarity = 1;
    return options;
  }
  /// Such options for the table "a.csv" of `num_rows` rows, which `row` makes of their numbers.
  template <class Row>
  ImportOptions table(const std::string& header, const Row& row, int rows = 0, int cols = 0,
                      int num_rows = 40) const {
    std::string text = header;
    for (int i = 0; i < num_rows; ++i) text += row(i);
    testing::put(folder_ / "a.csv", text);
    return alone("a.csv", rows, cols);
  }
  /// Imports a glove alone, on any clock.
  GloveStream import_alone(const ImportOptions& options) {
    return import({}, options).recording().gloves.at(0);
  }
  /// Imports a glove alone, on the clock of write_glove_files.py.
  GloveStream glove(const ImportOptions& options) {
    const RecordingReader reader = import({}, options);
    EXPECT_EQ(reader.recording().camera_times.frames(), 0u);
    EXPECT_NEAR(reader.recording().epoch_unix_s, glove_start_s, 1e-5);
    return reader.recording().gloves.at(0);
  }
  void expect_glove_rejected(const ImportOptions& options, const std::string& text) {
    expect_rejected({}, text, options, ExitCode::data);
  }
  static void expect_counts(const GloveStream& glove, int frames) {
    ASSERT_EQ(glove.info.rows, 4);
    ASSERT_EQ(glove.info.cols, 3);
    ASSERT_EQ(glove.frames(), std::size_t(frames));
    for (int frame = 0; frame < frames; ++frame)
      for (int i = 0; i < taxels; ++i)
        ASSERT_EQ(glove.counts[std::size_t(frame * taxels + i)], glove_count(frame, i));
    EXPECT_EQ(glove.info.bits, 12);
    EXPECT_EQ(glove.info.polarity, -1);
    EXPECT_NEAR(glove.info.rate_hz, 20.0, 1e-3);
    for (int i = 0; i < taxels; ++i)  // median of three equally frequent counts
      EXPECT_EQ(glove.info.baseline_counts[std::size_t(i)], 3000 + 10 * (i / 3) + i % 3);
  }
};

}  // namespace touchtrace
