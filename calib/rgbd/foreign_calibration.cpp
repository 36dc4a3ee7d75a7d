#include "calib/rgbd/foreign_calibration.h"

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace {
namespace {

using nlohmann::json;

constexpr std::uintmax_t most_foreign_bytes = 1u << 20;
constexpr int most_nodes = 100'000, deepest = 32;

void require_foreign(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument(what);
}

/// Aliases are followed, so nodes are counted: a small file can name itself many times over.
class JsonOfYaml {
 public:
  json convert(const YAML::Node& node, int depth = 0) {
    require_foreign(++nodes_ <= most_nodes && depth <= deepest,
                    "it is too large or nested too deeply");
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

/// cv::FileStorage begins with a directive that YAML does not know.
json parsed(std::string text) {
  if (text.starts_with("%YAML:")) text.erase(0, text.find('\n'));
  return JsonOfYaml().convert(YAML::Load(text));
}

json camera(const json& width, const json& height, const json& intrinsics, json distortion) {
  require_foreign(distortion.is_array() &&
                      (distortion.empty() || distortion.size() == 4 || distortion.size() == 5),
                  "its distortion does not have 0, 4 or 5 coefficients");
  while (distortion.size() < 5) distortion.push_back(0.0);
  return {{"width", width},
          {"height", height},
          {"intrinsics_px", intrinsics},
          {"distortion_k1_k2_p1_p2_k3", distortion}};
}

/// camera_info and cv::FileStorage agree in what they call things.
json camera_of_matrices(const json& y) {
  require_foreign(y.value("distortion_model", "plumb_bob") == "plumb_bob",
                  "its distortion model is not plumb_bob");
  const json& k = y.at("camera_matrix").at("data");
  require_foreign(k.is_array() && k.size() == 9 && k[1] == 0.0, "its camera matrix is none");
  return camera(y.at("image_width"), y.at("image_height"), {k[0], k[4], k[2], k[5]},
                y.at("distortion_coefficients").at("data"));
}

json camera_of_camchain(const json& y) {
  require_foreign(y.at("camera_model") == "pinhole", "its camera model is not pinhole");
  const std::string model = y.at("distortion_model");
  require_foreign(model == "radtan" || model == "none",
                  "its distortion model is neither radtan nor none");
  const json& size = y.at("resolution");
  return camera(size.at(0), size.at(1), y.at("intrinsics"),
                model == "none" ? json::array() : y.at("distortion_coeffs"));
}

json identity() {
  return {{1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 0.0}, {0.0, 0.0, 0.0, 1.0}};
}

/// The document that `calibrate` would have written of these cameras.
json document_of(const json& y) {
  require_foreign(y.is_object(), "it is no YAML mapping");
  const bool chain = y.contains("cam0"), pair = y.contains("cam1");
  require_foreign(chain || y.contains("camera_matrix"),
                  "it is neither a camera_info nor a cv::FileStorage nor a camchain");
  return {{"schema", "touchtrace/calibration/1"},
          {"color", chain ? camera_of_camchain(y.at("cam0")) : camera_of_matrices(y)},
          {"depth", pair ? camera_of_camchain(y.at("cam1")) : json()},
          {"depth_from_color", pair ? y.at("cam1").at("T_cn_cnm1") : identity()},
          {"depth_scale", 1.0},
          {"depth_offset_m", 0.0},
          {"rms_px", 0.0},
          {"depth_rms_m", 0.0},
          {"parameters", json::array()},
          {"covariance", json::array()},
          {"details", {{"verdict", "IMPORTED"}}}};
}

struct FourCoefficients {
  std::array<double, 4> values;  ///< k1 k2 p1 p2
  double worst_px;
};

/// The distortion is linear in its coefficients: least squares over the rays of a grid of pixels.
FourCoefficients without_k3(const PinholeCamera& c) {
  FourCoefficients four{{c.distortion[0], c.distortion[1], c.distortion[2], c.distortion[3]}, 0.0};
  if (c.distortion[4] == 0.0) return four;
  constexpr int cells = 20;
  Eigen::MatrixX4d design = Eigen::MatrixX4d::Zero(2 * (cells + 1) * (cells + 1), 4);
  Eigen::VectorXd left_out = Eigen::VectorXd::Zero(design.rows());
  Eigen::Index row = 0;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j, row += 2) {
      const Eigen::Vector3d ray =
          c.unproject({(c.width - 1.0) * i / cells, (c.height - 1.0) * j / cells});
      if (!ray.allFinite()) continue;  // no lens looks there
      const double x = ray.x(), y = ray.y(), r2 = x * x + y * y;
      design.row(row) << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x;
      design.row(row + 1) << y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y;
      left_out.segment<2>(row) = c.distortion[4] * r2 * r2 * r2 * ray.head<2>();
    }
  const Eigen::Vector4d change = design.colPivHouseholderQr().solve(left_out);
  for (int i = 0; i < 4; ++i) four.values[static_cast<std::size_t>(i)] += change[i];
  const Eigen::VectorXd error = design * change - left_out;
  for (row = 0; row < error.size(); row += 2)
    four.worst_px = std::max(four.worst_px, std::hypot(c.fx * error[row], c.fy * error[row + 1]));
  return four;
}

std::string camchain_entry(const char* name, const char* topic, const PinholeCamera& c) {
  const FourCoefficients four = without_k3(c);
  const auto& d = four.values;
  std::string text = fmt::format("{}:\n", name);
  if (c.distortion[4] != 0.0)
    text += fmt::format("  # k3 = {:#} is made up for by the others to {:.3f} px in the image\n",
                        c.distortion[4], four.worst_px);
  return text + fmt::format(
                    "  camera_model: pinhole\n  intrinsics: [{:#}, {:#}, {:#}, {:#}]\n"
                    "  distortion_model: radtan\n  distortion_coeffs: [{:#}, {:#}, {:#}, {:#}]\n"
                    "  resolution: [{}, {}]\n  rostopic: {}\n",
                    c.fx, c.fy, c.cx, c.cy, d[0], d[1], d[2], d[3], c.width, c.height, topic);
}

}  // namespace

std::string camchain_yaml(const RgbdCalibration& calibration) {
  std::string text = camchain_entry("cam0", "/camera/color/image_raw", calibration.color);
  if (!calibration.depth) return text;
  text += camchain_entry("cam1", "/camera/depth/image_raw", *calibration.depth);
  text += "  T_cn_cnm1:\n";
  const Eigen::Matrix4d m = calibration.depth_from_color.matrix();
  for (int i = 0; i < 4; ++i)
    text += fmt::format("  - [{:#}, {:#}, {:#}, {:#}]\n", m(i, 0), m(i, 1), m(i, 2), m(i, 3));
  return text;
}

std::string file_storage_yaml(const PinholeCamera& c) {
  cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  const cv::Matx33d camera_matrix(c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0);
  const cv::Mat distortion(5, 1, CV_64F, const_cast<double*>(c.distortion.data()));
  storage << "image_width" << c.width << "image_height" << c.height;
  storage << "camera_matrix" << cv::Mat(camera_matrix) << "distortion_coefficients" << distortion;
  return storage.releaseAndGetString();
}

RgbdCalibration read_foreign_calibration(const std::filesystem::path& file) {
  const std::string text = read_file(file, most_foreign_bytes);
  try {
    return calibration_from_json(document_of(parsed(text)));
  } catch (const std::exception& error) {
    throw data_error(
        fmt::format("{} is not a usable calibration: {}", file.string(), error.what()),
        "give a folder of `touchtrace calibrate`, a camera_info, a cv::FileStorage or a camchain");
  }
}

}  // namespace touchtrace
