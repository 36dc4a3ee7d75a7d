#include "calib/rgbd/foreign_calibration.h"

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "calib/matrix/decomposition.h"
#include "calib/rgbd/calibration_json.h"
#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace {
namespace {

using nlohmann::json;

constexpr std::uintmax_t max_foreign_bytes = 1u << 20;
constexpr int max_yaml_nodes = 100'000, max_yaml_depth = 32;

void require_foreign(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument(what);
}

/// Converts YAML to JSON. Limits the number of nodes: a small file with nested aliases can expand
/// to any size.
class YamlConverter {
 public:
  json convert(const YAML::Node& node, int depth = 0) {
    require_foreign(++nodes_ <= max_yaml_nodes && depth <= max_yaml_depth,
                    "too large or nested too deeply");
    json result;
    if (node.IsMap()) {
      result = json::object();
      for (const auto& item : node)
        result[item.first.as<std::string>()] = convert(item.second, depth + 1);
    } else if (node.IsSequence()) {
      result = json::array();
      for (const auto& item : node) result.push_back(convert(item, depth + 1));
    } else if (node.IsScalar()) {
      double number = 0.0;
      result = YAML::convert<double>::decode(node, number) ? json(number) : json(node.Scalar());
    }
    return result;
  }

 private:
  int nodes_ = 0;
};

/// Camera with the simplest lens that has all nonzero coefficients and that `accepts` accepts.
template <class Accepts>
json camera(const json& width, const json& height, const json& intrinsics, const json& distortion,
            Accepts&& accepts) {
  const std::vector<double> values = distortion;
  for (const Lens& lens : all_lenses()) {
    const auto names = coefficient_names(lens);
    if (!accepts(lens)) continue;
    if (std::any_of(values.begin() + std::min(names.size(), values.size()), values.end(),
                    [](double value) { return value != 0.0; }))
      continue;
    json coefficients = json::object();
    for (std::size_t i = 0; i < names.size(); ++i)
      coefficients[names[i]] = i < values.size() ? values[i] : 0.0;
    return {{"width", width},
            {"height", height},
            {"lens", lens_name(lens)},
            {"intrinsics_px", intrinsics},
            {"distortion", coefficients}};
  }
  throw std::invalid_argument("its lens model is not supported");
}

bool is_known_model(const std::string& name, const char* LensInterop::*program) {
  return std::ranges::any_of(all_lenses(), [&](const Lens& lens) {
    const char* known = lens_interop(lens).*program;
    return known != nullptr && name == known;
  });
}

bool is_camera_info_message(const json& y) { return y.contains("K") || y.contains("k"); }

/// The keys of a camera_info file for those of a sensor_msgs/CameraInfo message: K and D as
/// `rostopic echo` prints them, k and d as `ros2 topic echo` does.
json with_file_keys(const json& message) {
  const bool is_ros1 = message.contains("K");
  return {
      {"image_width", message.at("width")},
      {"image_height", message.at("height")},
      {"distortion_model", message.value("distortion_model", "")},
      {"camera_matrix", {{"data", message.at(is_ros1 ? "K" : "k")}}},
      {"distortion_coefficients", {{"data", message.value(is_ros1 ? "D" : "d", json::array())}}}};
}

/// Camera of a camera_info, which names the lens, or a cv::FileStorage, which has at most
/// fisheye_model. A model of another name is accepted if all its coefficients are zero.
json camera_from_matrices(const json& y) {
  const bool fisheye = y.value("fisheye_model", 0.0) != 0.0;
  std::string model = y.value("distortion_model", "");
  const json& coefficients = y.at("distortion_coefficients").at("data");
  if (!is_known_model(model, &LensInterop::ros) &&
      std::ranges::all_of(coefficients, [](const json& value) { return value == 0.0; }))
    model.clear();
  require_foreign(model.empty() || is_known_model(model, &LensInterop::ros),
                  fmt::format("unsupported distortion model '{}'", model));
  const json& k = y.at("camera_matrix").at("data");
  require_foreign(k.is_array() && k.size() == 9 && k[1] == 0.0,
                  "camera_matrix is not a 3x3 matrix without skew");
  return camera(y.at("image_width"), y.at("image_height"), {k[0], k[4], k[2], k[5]}, coefficients,
                [&](const Lens& lens) {
                  return model.empty() ? is_perspective(lens) != fisheye
                                       : model == lens_interop(lens).ros;
                });
}

json camera_from_camchain(const json& y) {
  require_foreign(y.at("camera_model") == "pinhole", "camera_model is not pinhole");
  const bool none = y.at("distortion_model") == "none";
  const std::string model = none ? "radtan" : y.at("distortion_model").get<std::string>();
  require_foreign(is_known_model(model, &LensInterop::kalibr),
                  fmt::format("unsupported distortion model '{}'", model));
  const json& size = y.at("resolution");
  const json coefficients = none ? json::array() : y.at("distortion_coeffs");
  require_foreign(none || coefficients.size() == 4, "distortion_coeffs does not have four values");
  return camera(size.at(0), size.at(1), y.at("intrinsics"), coefficients, [&](const Lens& lens) {
    const char* name = lens_interop(lens).kalibr;
    return name != nullptr && model == name;
  });
}

json identity() {
  return {{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}, {0.0, 0.0, 0.0, 1.0}};
}

/// Converts to the content of calibration.json.
json to_calibration_json(const json& y) {
  require_foreign(y.is_object(), "not a YAML mapping");
  if (is_camera_info_message(y)) return to_calibration_json(with_file_keys(y));
  const bool chain = y.contains("cam0"), pair = y.contains("cam1");
  require_foreign(chain || y.contains("camera_matrix"),
                  "not a camera_info, cv::FileStorage or camchain");
  return {{"schema", calibration_schema},
          {"color", chain ? camera_from_camchain(y.at("cam0")) : camera_from_matrices(y)},
          {"depth", pair ? camera_from_camchain(y.at("cam1")) : json()},
          {"depth_from_color", pair ? y.at("cam1").at("T_cn_cnm1") : identity()},
          {"depth_scale", 1.0},
          {"depth_offset_m", 0.0},
          {"depth_delay_s", 0.0},
          {"board_warp_m", {0.0, 0.0}},
          {"rms_px", 0.0},
          {"depth_rms_m", 0.0},
          {"parameters", json::array()},
          {"covariance", json::array()},
          {"details", {{"verdict", "IMPORTED"}}}};
}

struct FourCoefficients {
  std::string model;
  std::array<double, 4> values;
  double max_error_px = 0.0;
};

/// Least-squares fit of radtan's k1 k2 p1 p2, in which the distortion is linear, to the camera's
/// lens over a grid of pixels.
FourCoefficients fit_radtan(const Camera& c) {
  constexpr int cells = 20;
  Eigen::MatrixX4d design = Eigen::MatrixX4d::Zero(2 * (cells + 1) * (cells + 1), 4);
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(design.rows());
  Eigen::Index row = 0;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j, row += 2) {
      const Eigen::Vector2d pixel((c.width - 1.0) * i / cells, (c.height - 1.0) * j / cells);
      const Eigen::Vector3d ray = c.unproject(pixel);
      if (!ray.allFinite()) continue;  // not invertible
      const double x = ray.x(), y = ray.y(), r2 = x * x + y * y;
      design.row(row) << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x;
      design.row(row + 1) << y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y;
      displacement.segment<2>(row) << (pixel.x() - c.cx) / c.fx - x, (pixel.y() - c.cy) / c.fy - y;
    }
  const Eigen::Vector4d k = least_squares(design, displacement).x;
  const Eigen::VectorXd error = design * k - displacement;
  FourCoefficients four{"radtan", {k[0], k[1], k[2], k[3]}};
  for (row = 0; row < error.size(); row += 2)
    four.max_error_px =
        std::max(four.max_error_px, std::hypot(c.fx * error[row], c.fy * error[row + 1]));
  return four;
}

FourCoefficients four_coefficients(const Camera& c) {
  const auto& d = c.distortion;
  const char* model = lens_interop(c.lens).kalibr;
  if (model == nullptr && d.tail<4>().isZero(0.0)) model = "radtan";
  return model != nullptr ? FourCoefficients{model, {d[0], d[1], d[2], d[3]}} : fit_radtan(c);
}

std::string camchain_entry(const std::string& name, const ChainCamera& entry) {
  const Camera& c = entry.camera;
  const FourCoefficients four = four_coefficients(c);
  const auto& d = four.values;
  std::string text = fmt::format("{}:\n", name);
  if (four.max_error_px > 0.0)
    text += fmt::format(
        "  # {} approximated by four coefficients; maximum error in the image {:.3f} px\n",
        lens_name(c.lens), four.max_error_px);
  return text + fmt::format(
                    "  camera_model: pinhole\n  intrinsics: [{:#}, {:#}, {:#}, {:#}]\n"
                    "  distortion_model: {}\n  distortion_coeffs: [{:#}, {:#}, {:#}, {:#}]\n"
                    "  resolution: [{}, {}]\n  rostopic: {}\n",
                    c.fx, c.fy, c.cx, c.cy, four.model, d[0], d[1], d[2], d[3], c.width, c.height,
                    entry.topic);
}

/// Calls `read` with the content of a YAML file.
template <class Read>
auto read_yaml(const std::filesystem::path& file, Read&& read) {
  const std::string text = read_file(file, max_foreign_bytes);
  try {
    return read(parse_yaml(text));
  } catch (const std::exception& error) {
    throw data_error(fmt::format("cannot read calibration {}: {}", file.string(), error.what()),
                     "use a folder of `touchtrace calibrate`, a camera_info (file or output of "
                     "`rostopic echo`), "
                     "a cv::FileStorage or a camchain");
  }
}

}  // namespace

json parse_yaml(std::string text) {
  require_foreign(text.size() <= max_foreign_bytes, "too large");
  // cv::FileStorage begins with a directive that is not valid YAML.
  if (text.starts_with("%YAML:")) text.erase(0, text.find('\n'));
  return YamlConverter().convert(YAML::Load(text));
}

std::string camchain_yaml(const std::vector<ChainCamera>& chain) {
  std::string text;
  for (std::size_t camera = 0; camera < chain.size(); ++camera) {
    text += camchain_entry(fmt::format("cam{}", camera), chain[camera]);
    if (camera == 0) continue;
    text += "  T_cn_cnm1:\n";
    const Eigen::Matrix4d m = chain[camera].from_previous.matrix();
    for (int i = 0; i < 4; ++i)
      text += fmt::format("  - [{:#}, {:#}, {:#}, {:#}]\n", m(i, 0), m(i, 1), m(i, 2), m(i, 3));
  }
  return text;
}

std::string camchain_yaml(const RgbdCalibration& calibration) {
  std::vector<ChainCamera> chain{{"/camera/color/image_raw", calibration.color}};
  if (calibration.depth)
    chain.push_back({"/camera/depth/image_raw", *calibration.depth, calibration.depth_from_color});
  return camchain_yaml(chain);
}

std::vector<ChainCamera> read_camchain(const std::filesystem::path& file) {
  return read_yaml(file, [](const json& y) {
    require_foreign(y.is_object() && y.contains("cam0"), "not a camchain");
    std::vector<ChainCamera> chain;
    for (std::string name = "cam0"; y.contains(name); name = fmt::format("cam{}", chain.size())) {
      const json& entry = y.at(name);
      ChainCamera camera{entry.value("rostopic", ""),
                         camera_from_json(camera_from_camchain(entry))};
      if (!chain.empty()) camera.from_previous = pose_from_json(entry.at("T_cn_cnm1"), "T_cn_cnm1");
      chain.push_back(std::move(camera));
    }
    return chain;
  });
}

std::string file_storage_yaml(const Camera& c) {
  cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  const cv::Matx33d camera_matrix(c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0);
  const cv::Mat distortion(lens_interop(c.lens).num_ros_coefficients, 1, CV_64F,
                           const_cast<double*>(c.distortion.data()));
  storage << "image_width" << c.width << "image_height" << c.height;
  storage << "camera_matrix" << cv::Mat(camera_matrix) << "distortion_coefficients" << distortion;
  storage << "fisheye_model" << int(!is_perspective(c.lens));
  return storage.releaseAndGetString();
}

Camera camera_from_info(const nlohmann::json& message) {
  return camera_from_json(camera_from_matrices(with_file_keys(message)));
}

RgbdCalibration read_foreign_calibration(const std::filesystem::path& file) {
  return read_yaml(file,
                   [](const json& y) { return calibration_from_json(to_calibration_json(y)); });
}

}  // namespace touchtrace
