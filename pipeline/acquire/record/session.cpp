#include "pipeline/acquire/record/session.h"

#include <fmt/core.h>

#include "calib/rgbd/calibration.h"
#include "engine/base/error.h"
#include "engine/base/finite.h"
#include "engine/base/json_number.h"

namespace touchtrace {
namespace {

constexpr int max_taxel_rows = 4096, max_image_side = 16384;
constexpr const char* log_hint = "give a log of `touchtrace record`";

nlohmann::json describe_glove(const GloveInfo& glove) {
  nlohmann::json json{{"name", glove.name}, {"rows", glove.rows},
                      {"cols", glove.cols}, {"rate_hz", glove.rate_hz},
                      {"bits", glove.bits}, {"polarity", glove.polarity}};
  if (!glove.baseline_counts.empty()) json["baseline_counts"] = glove.baseline_counts;
  return json;
}

/// Cameras that a driver or file describes, as in calibration.json.
nlohmann::json describe_lenses(const CameraInfo& camera) {
  RgbdCalibration calibration;
  calibration.color = *camera.color_camera;
  calibration.depth = camera.depth_camera;
  calibration.depth_from_color = camera.depth_from_color.value_or(Eigen::Isometry3d::Identity());
  return {{"calibration", calibration_json(calibration)},
          {"is_pose_known", camera.depth_from_color.has_value()}};
}

void parse_lenses(const nlohmann::json& json, CameraInfo& camera) {
  const RgbdCalibration calibration = calibration_from_json(json.at("calibration"));
  camera.color_camera = calibration.color;
  camera.depth_camera = calibration.depth;
  if (json.at("is_pose_known").get<bool>()) camera.depth_from_color = calibration.depth_from_color;
}

nlohmann::json describe_camera(const CameraInfo& camera) {
  nlohmann::json json{{"width", camera.width},
                      {"height", camera.height},
                      {"rate_hz", camera.rate_hz},
                      {"depth_unit_m", camera.depth_unit_m},
                      {"depth_width", camera.depth_width},
                      {"depth_height", camera.depth_height},
                      {"registered", camera.is_registered}};
  if (camera.color_camera) json["lenses"] = describe_lenses(camera);
  return json;
}

int number_between(const nlohmann::json& json, const char* key, int minimum, int maximum) {
  return static_cast<int>(whole_number(json.at(key), key, minimum, maximum));
}

double positive_number(const nlohmann::json& json, const char* key) {
  const auto value = json.at(key).get<double>();
  if (!(value > 0.0 && value < 1e6))
    throw data_error(fmt::format("the log says {} = {}, expected a positive number", key, value),
                     log_hint);
  return value;
}

std::vector<float> parse_baseline(const nlohmann::json& json, const GloveInfo& glove) {
  auto counts = json.get<std::vector<float>>();
  if (std::ssize(counts) != glove.taxels() || !all_finite(counts))
    throw data_error(
        fmt::format("the log has a baseline of {} counts, expected {} finite ones, one per taxel",
                    counts.size(), glove.taxels()),
        log_hint);
  return counts;
}

GloveInfo parse_glove(const nlohmann::json& json) {
  GloveInfo glove;
  glove.name = json.at("name").get<std::string>();
  glove.rows = number_between(json, "rows", 1, max_taxel_rows);
  glove.cols = number_between(json, "cols", 1, max_taxel_rows);
  glove.rate_hz = positive_number(json, "rate_hz");
  glove.bits = number_between(json, "bits", 1, 16);
  glove.polarity = number_between(json, "polarity", -1, 1) < 0 ? -1 : 1;
  if (json.contains("baseline_counts"))
    glove.baseline_counts = parse_baseline(json["baseline_counts"], glove);
  return glove;
}

CameraInfo parse_camera(const nlohmann::json& json) {
  CameraInfo camera;
  camera.width = number_between(json, "width", 0, max_image_side);
  camera.height = number_between(json, "height", 0, max_image_side);
  camera.depth_width = number_between(json, "depth_width", 0, max_image_side);
  camera.depth_height = number_between(json, "depth_height", 0, max_image_side);
  camera.rate_hz = positive_number(json, "rate_hz");
  camera.depth_unit_m = positive_number(json, "depth_unit_m");
  camera.is_registered = json.at("registered").get<bool>();
  if (json.contains("lenses")) parse_lenses(json["lenses"], camera);
  return camera;
}

SessionInfo parse(const nlohmann::json& json) {
  SessionInfo session;
  session.activity = json.at("activity").get<std::string>();
  session.object = json.at("object").get<std::string>();
  session.protocol = json.at("protocol").get<std::string>();
  session.epoch_unix_s = json.at("epoch_unix_s").get<double>();
  session.rest_s = json.at("rest_s").get<double>();
  if (json.contains("glove")) session.glove = parse_glove(json["glove"]);
  if (json.contains("camera")) session.camera = parse_camera(json["camera"]);
  session.provenance = json.at("provenance").get<Provenance>();
  return session;
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const SessionInfo& session) {
  nlohmann::json json{{"activity", session.activity}, {"object", session.object},
                      {"protocol", session.protocol}, {"epoch_unix_s", session.epoch_unix_s},
                      {"rest_s", session.rest_s},     {"provenance", session.provenance}};
  if (session.glove) json["glove"] = describe_glove(*session.glove);
  if (session.camera) json["camera"] = describe_camera(*session.camera);
  const std::string text = json.dump();
  return {text.begin(), text.end()};
}

SessionInfo parse_session(std::span<const std::uint8_t> bytes) {
  try {
    return parse(nlohmann::json::parse(bytes.begin(), bytes.end()));
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw data_error(fmt::format("the log's description is invalid: {}", error.what()), log_hint);
  }
}

}  // namespace touchtrace
