#include <algorithm>

#include "calib/rgbd/calibration.h"
#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/train/model_file.h"
#include "pipeline/acquire/record/log.h"
#include "tests/verify/record/child_program.h"
#include "tests/verify/record/verify_record.h"
#include "tests/verify/study/noise_model.h"
#include "tests/verify/support/bit_flips.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using Emit = std::function<void(Figure)>;

constexpr int num_flips = 10'000;

void emit_flips(const Emit& emit, const std::string& kind, const BitFlips& flips) {
  emit(reported("record: flipped bits detected in a " + kind + ", of 10000", flips.detected,
                "flips"));
  emit(at_most("record: flipped bits that changed a " + kind + " silently", flips.silent, "flips",
               0.0));
}

void measure_log(const fs::path& path, const Emit& emit) {
  RandomStream random(1, "log flips");
  constexpr std::size_t num_records = 20;
  {
    LogWriter log(path);
    for (std::size_t i = 0; i < num_records; ++i) {
      std::vector<std::uint8_t> payload(random.below(200));
      for (auto& byte : payload) byte = static_cast<std::uint8_t>(random.below(256));
      log.append(RecordKind::glove_frame, payload);
    }
  }
  std::size_t min_found = num_records;
  const BitFlips flips = flip_bits(path, num_flips, [&] {
    LogReader reader(path);
    std::string payloads;
    std::size_t found = 0;
    for (; const auto record = reader.next(); ++found)
      payloads.append(record->payload.begin(), record->payload.end());
    min_found = std::min(min_found, found);
    if (!reader.damage().is_torn_only() || reader.damage().torn_bytes > 0)
      throw data_error("the log is damaged", "");
    return payloads;
  });
  emit_flips(emit, "log", flips);
  emit(at_most("record: records lost by one flipped bit",
               static_cast<double>(num_records - min_found), "records", 1.0));
}

void measure_model(const fs::path& path, const Emit& emit) {
  ModelSpec spec;
  spec.rows = spec.cols = 8, spec.embedding = 16, spec.hidden = 64;
  Child([&] {
    Runtime runtime(choose_device(""));
    write_noise_model(runtime, path, spec, 15.0);
    return 0;
  }).require_success("writing a model");
  emit_flips(emit, "model", flip_bits(path, num_flips, [&] {
               const ModelFile model = read_model_file(path);
               std::string content = nlohmann::json(model.file.metadata).dump();
               for (const Tensor& tensor : model.file.tensors) {
                 content += tensor.name + nlohmann::json(tensor.shape).dump();
                 content.append(reinterpret_cast<const char*>(tensor.values.data()),
                                tensor.values.size() * sizeof(float));
               }
               return content;
             }));
}

void measure_calibration(const fs::path& folder, const Emit& emit) {
  RgbdCalibration calibration;
  calibration.color = {640, 480, 600.5, 601.25, 320.0, 240.0};
  calibration.depth = calibration.color;
  calibration.parameters = {"color.fx", "color.fy", "color.cx", "color.cy"};
  calibration.covariance = 0.1 * Eigen::Matrix4d::Identity();
  calibration.details = {{"verdict", "GOOD"}};
  write_calibration(folder, calibration, true);
  emit_flips(emit, "calibration", flip_bits(folder / "calibration.json", num_flips, [&] {
               return calibration_json(read_calibration(folder)).dump();
             }));
}

}  // namespace

void measure_flips(const fs::path& folder, const Emit& emit) {
  measure_log(folder / "flips.log", emit);
  measure_model(folder / "flips.safetensors", emit);
  measure_calibration(folder / "flips", emit);
}

}  // namespace touchtrace
