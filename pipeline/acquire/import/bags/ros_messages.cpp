#include "pipeline/acquire/import/bags/ros_messages.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace touchtrace {
namespace {

constexpr std::uint32_t max_image_size = 16384;
constexpr int keep = -1;

struct Encoding {
  const char* name;
  int type;
  int to_bgr;  ///< cv::ColorConversionCodes, or `keep`
};

constexpr Encoding encodings[] = {{"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
                                  {"bgr8", CV_8UC3, keep},
                                  {"8UC3", CV_8UC3, keep},
                                  {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR},
                                  {"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR},
                                  {"mono8", CV_8UC1, cv::COLOR_GRAY2BGR},
                                  {"8UC1", CV_8UC1, cv::COLOR_GRAY2BGR},
                                  {"16UC1", CV_16UC1, keep},
                                  {"mono16", CV_16UC1, keep},
                                  {"32FC1", CV_32FC1, keep}};

const Encoding& find_encoding(const std::string& name) {
  const auto* found = std::ranges::find(encodings, name, &Encoding::name);
  if (found == std::end(encodings))
    throw std::runtime_error(fmt::format("encoding '{}' is not supported", name));
  return *found;
}

/// Reads the members of a message. CDR: aligned to their size from the end of a header of 4 bytes,
/// texts end with a zero; little-endian, version 1 (ROS 2's).
class RosReader {
 public:
  RosReader(ByteSpan message, RosSerialization serialization)
      : message_(message), reader_(message), is_cdr_(serialization == RosSerialization::cdr) {
    if (!is_cdr_) return;
    const ByteSpan header = take(4);
    if (header[0] != 0 || header[1] != 1)
      throw std::runtime_error(
          fmt::format("CDR of kind {} {} is not supported", header[0], header[1]));
  }

  template <class T>
  T number() {
    if (is_cdr_) take((sizeof(T) - (position_ - cdr_header) % sizeof(T)) % sizeof(T));
    position_ += sizeof(T);
    return reader_.number<T>();
  }

  template <class T>
  std::vector<T> numbers(std::size_t count) {
    if (count > message_.size() / sizeof(T)) throw std::out_of_range("data end early");
    std::vector<T> result;
    for (std::size_t i = 0; i < count; ++i) result.push_back(number<T>());
    return result;
  }

  std::string text() {
    const ByteSpan bytes = take(number<std::uint32_t>());
    const std::size_t end = is_cdr_ && !bytes.empty() ? 1 : 0;
    return {bytes.begin(), bytes.end() - static_cast<std::ptrdiff_t>(end)};
  }

  ByteSpan take(std::size_t size) {
    position_ += size;
    return reader_.take(size);
  }

  /// Reads a std_msgs/Header.
  void header(RosImage& image) {
    if (!is_cdr_) take(4);  // seq
    const auto seconds = number<std::uint32_t>(), nanoseconds = number<std::uint32_t>();
    image.stamp_s = seconds + 1e-9 * nanoseconds;
    image.frame_id = text();
  }

 private:
  static constexpr std::size_t cdr_header = 4;

  ByteSpan message_;
  ByteReader reader_;
  bool is_cdr_;
  std::size_t position_ = 0;
};

cv::Mat decode_raw(const RosImage& image) {
  const Encoding& encoding = find_encoding(image.encoding);
  const std::size_t row_bytes = image.width * CV_ELEM_SIZE(encoding.type);
  if (image.width == 0 || image.height == 0 || std::max(image.width, image.height) > max_image_size)
    throw std::runtime_error(fmt::format("size of {}x{} pixels", image.width, image.height));
  if (image.step < row_bytes || image.data.size() < std::size_t{image.step} * image.height)
    throw std::runtime_error("fewer bytes than pixels");
  if (image.is_big_endian && CV_ELEM_SIZE1(encoding.type) > 1)
    throw std::runtime_error("big-endian pixels are not supported");
  cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), encoding.type);
  for (int row = 0; row < pixels.rows; ++row)
    std::memcpy(pixels.ptr(row), image.data.data() + std::size_t{image.step} * row, row_bytes);
  if (encoding.to_bgr != keep) cv::cvtColor(pixels, pixels, encoding.to_bgr);
  return pixels;
}

cv::Mat decode_file(ByteSpan data, int flags) {
  if (data.empty()) throw std::runtime_error("no data");
  const cv::Mat bytes(1, static_cast<int>(data.size()), CV_8U,
                      const_cast<std::uint8_t*>(data.data()));
  cv::Mat pixels = cv::imdecode(bytes, flags);
  if (pixels.empty()) throw std::runtime_error("not a readable image");
  return pixels;
}

/// Decodes an image of compressed_depth_image_transport: a header of 12 bytes and a PNG. Pixels of
/// 32FC1 are inverse depths, a / (count - b).
cv::Mat decode_compressed_depth(const RosImage& image) {
  ByteReader reader(image.data);
  reader.take(4);
  const auto a = reader.number<float>(), b = reader.number<float>();
  const cv::Mat counts = decode_file(image.data.subspan(12), cv::IMREAD_UNCHANGED);
  if (!image.encoding.starts_with("32FC1")) return counts;
  cv::Mat inverse, depth;
  counts.convertTo(inverse, CV_32F, 1.0 / a, -b / a);
  cv::divide(1.0, inverse, depth);
  depth.setTo(0.0f, counts == 0);
  return depth;
}

}  // namespace

bool RosImage::is_depth() const {
  return std::ranges::any_of(std::array{"16UC1", "mono16", "32FC1"},
                             [&](const char* name) { return encoding.starts_with(name); }) ||
         encoding.find("compressedDepth") != std::string::npos;
}

bool is_image_type(const std::string& type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage";
}

RosImage parse_image(ByteSpan message, const std::string& type, RosSerialization serialization) {
  RosReader reader(message, serialization);
  RosImage image;
  reader.header(image);
  image.is_compressed = type == "sensor_msgs/CompressedImage";
  if (!image.is_compressed)
    image.height = reader.number<std::uint32_t>(), image.width = reader.number<std::uint32_t>();
  image.encoding = reader.text();
  if (!image.is_compressed) {
    image.is_big_endian = reader.number<std::uint8_t>() != 0;
    image.step = reader.number<std::uint32_t>();
  }
  image.data = reader.take(reader.number<std::uint32_t>());
  return image;
}

nlohmann::json parse_camera_info(ByteSpan message, RosSerialization serialization) {
  RosReader reader(message, serialization);
  RosImage header;
  reader.header(header);
  const auto height = reader.number<std::uint32_t>(), width = reader.number<std::uint32_t>();
  const std::string model = reader.text();
  const auto distortion = reader.numbers<double>(reader.number<std::uint32_t>());
  return {{"height", height},
          {"width", width},
          {"distortion_model", model},
          {"D", distortion},
          {"K", reader.numbers<double>(9)}};
}

float parse_float32(ByteSpan message) { return ByteReader(message).number<float>(); }

cv::Mat decode(const RosImage& image) {
  if (!image.is_compressed) return decode_raw(image);
  if (image.encoding.find("compressedDepth") != std::string::npos)
    return decode_compressed_depth(image);
  return decode_file(image.data, image.is_depth() ? cv::IMREAD_UNCHANGED : cv::IMREAD_COLOR);
}

}  // namespace touchtrace
