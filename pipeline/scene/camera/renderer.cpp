#include "pipeline/scene/camera/renderer.h"

#include <algorithm>

#include "engine/base/random.h"
#include "pipeline/scene/camera/packed_solids.h"
#include "pipeline/scene/camera/ray_map.h"

namespace touchtrace::scene {

/// Rays of one camera on the device.
struct RayBuffers {
  Buffer<float> x, y, tiles, strips;
  cl::NDRange grid;
  cl_float2 pitch;
};

namespace {

constexpr int noise_fields = 4, halo_px = 128;
constexpr double nearest_occluder_m = 0.5;
constexpr double exposure_gain = 0.95;
/// Largest lateral shift of a depth ray, in standard deviations.
constexpr double max_normal = 6.0;

/// Direction to the lamp: above and left of the camera, behind it.
const Eigen::Vector3d lamp_world = Eigen::Vector3d(-0.45, -0.75, 0.55).normalized();

RayBuffers upload_rays(Runtime& runtime, const Camera& camera, double margin_px) {
  const RayMap map = make_ray_map(camera, margin_px);
  const auto upload = [&](const std::vector<float>& v) { return runtime.upload(std::span(v)); };
  return {upload(map.x),
          upload(map.y),
          upload(map.tiles),
          upload(map.strips),
          cl::NDRange(static_cast<std::size_t>(map.tile_columns),
                      static_cast<std::size_t>(map.tile_lines)),
          {{static_cast<float>(1.0 / camera.fx), static_cast<float>(1.0 / camera.fy)}}};
}

std::size_t padded_size(const Camera& camera) {
  return static_cast<std::size_t>(camera.width + 2 * halo_px) *
         static_cast<std::size_t>(camera.height + 2 * halo_px);
}

Defines defines() {
  return {{"TILE_ROWS", std::to_string(RayMap::tile_rows)},
          {"MAX_SOLIDS", std::to_string(max_solids)},
          {"HALO", std::to_string(halo_px)}};
}

template <class... Arguments>
void set_arguments(cl::Kernel& kernel, const Arguments&... arguments) {
  cl_uint i = 0;
  (kernel.setArg(i++, arguments), ...);
}

/// Sensor pixels per image pixel.
double sensor_px_per_px(const Camera& camera) {
  return static_cast<double>(sensor_width_px) / camera.width;
}

/// Width of the widest occlusion shadow in image pixels; 0 without holes.
int max_shadow_px(const RgbdCamera& camera) {
  if (!camera.sensor.holes) return 0;
  const double widest_px = camera.depth.fx * camera.sensor.baseline_m / nearest_occluder_m;
  return std::min(static_cast<int>(widest_px), halo_px - 1);
}

}  // namespace

struct Renderer::Device {
  Runtime& runtime;
  RayBuffers color_rays, depth_rays;
  Buffer<float> solids, depth_solids, fields, disparity;
  Buffer<std::uint8_t> color;
  Buffer<std::uint16_t> counts;
  cl::Kernel render_color, depth_noise, render_depth, measure_depth;
  std::vector<float> packed, depth_packed;  ///< kept alive during the upload

  Device(Runtime& r, const RgbdCamera& camera);
  void upload(const RgbdCamera& camera, const Exposure& exposure);
  void launch_color(const RgbdCamera& camera, const Exposure& exposure, cl_uint2 key,
                    int samples_per_axis);
  void launch_depth(const RgbdCamera& camera, const Exposure& exposure, cl_uint2 key);
  void launch_measurement(const RgbdCamera& camera);
};

Renderer::Device::Device(Runtime& r, const RgbdCamera& camera)
    : runtime(r),
      color_rays(upload_rays(r, camera.color, 0.5)),
      depth_rays(
          upload_rays(r, camera.depth,
                      max_normal * camera.sensor.shift_sigma_px / sensor_px_per_px(camera.depth))),
      fields(r.allocate<float>(noise_fields * padded_size(camera.depth))),
      disparity(r.allocate<float>(padded_size(camera.depth))),
      color(r.allocate<std::uint8_t>(color_rays.x.size() * 3)),
      counts(r.allocate<std::uint16_t>(depth_rays.x.size())) {
  using Files = std::vector<std::string>;
  const Files color_files{"pixel_vectors.clh", "solids.clh",      "visible_solids.clh",
                          "surface.clh",       "image_noise.clh", "render_color.cl"};
  const Files depth_files{"pixel_vectors.clh", "solids.clh",       "visible_solids.clh",
                          "image_noise.clh",   "depth_fields.clh", "render_depth.cl",
                          "measure_depth.cl"};
  const auto kernel = [&](const Files& files, const char* name) {
    return r.create(r.kernel(files, name, defines()));
  };
  render_color = kernel(color_files, "render_color");
  depth_noise = kernel(depth_files, "depth_noise");
  render_depth = kernel(depth_files, "render_depth");
  measure_depth = kernel(depth_files, "measure_depth");
  r.queue().enqueueFillBuffer(disparity.handle(), 0.0f, 0, disparity.size() * sizeof(float));
}

void Renderer::Device::upload(const RgbdCamera& camera, const Exposure& exposure) {
  packed = pack_solids(exposure.color, camera.color_from_world, lamp_world);
  depth_packed =
      pack_solids({exposure.depth}, camera.depth_from_color * camera.color_from_world, lamp_world);
  if (solids.size() < packed.size()) solids = runtime.allocate<float>(packed.size());
  if (depth_solids.size() < depth_packed.size())
    depth_solids = runtime.allocate<float>(depth_packed.size());
  runtime.enqueue_write(solids, packed);
  runtime.enqueue_write(depth_solids, depth_packed);
}

void Renderer::Device::launch_color(const RgbdCamera& camera, const Exposure& exposure,
                                    cl_uint2 key, int samples_per_axis) {
  const auto noise = static_cast<float>(camera.color_noise_counts / sensor_px_per_px(camera.color));
  set_arguments(render_color, color_rays.x.handle(), color_rays.y.handle(),
                color_rays.tiles.handle(), color_rays.strips.handle(), solids.handle(),
                static_cast<cl_int>(exposure.color.front().size()),
                static_cast<cl_int>(exposure.color.size()), samples_per_axis, color_rays.pitch,
                static_cast<float>(exposure_gain), noise, key, camera.color.width,
                camera.color.height, color.handle());
  runtime.launch(render_color, color_rays.grid, cl::NDRange(1, 1));
}

void Renderer::Device::launch_depth(const RgbdCamera& camera, const Exposure& exposure,
                                    cl_uint2 key) {
  const int width = camera.depth.width, height = camera.depth.height;
  set_arguments(depth_noise, key, width, height, fields.handle());
  runtime.launch(depth_noise, cl::NDRange(depth_rays.grid[0] + 2, depth_rays.grid[1] + 2),
                 cl::NDRange(1, 1));
  const auto shift =
      static_cast<float>(camera.sensor.shift_sigma_px / sensor_px_per_px(camera.depth));
  set_arguments(render_depth, depth_rays.x.handle(), depth_rays.y.handle(),
                depth_rays.tiles.handle(), depth_solids.handle(),
                static_cast<cl_int>(exposure.depth.size()),
                cl_float2{{shift * depth_rays.pitch.s[0], shift * depth_rays.pitch.s[1]}},
                static_cast<float>(camera.depth.fx * camera.sensor.baseline_m), width, height,
                fields.handle(), disparity.handle());
  runtime.launch(render_depth, depth_rays.grid, cl::NDRange(1, 1));
}

void Renderer::Device::launch_measurement(const RgbdCamera& camera) {
  const DepthSensor& s = camera.sensor;
  const auto f = [](double value) { return static_cast<float>(value); };
  set_arguments(measure_depth, disparity.handle(), fields.handle(),
                cl_float4{{f(s.disparity_sigma_px), f(s.disparity_step_px), f(s.min_depth_m),
                           f(s.max_depth_m)}},
                f(camera.depth.fx * s.baseline_m), f(sensor_px_per_px(camera.depth)),
                cl_float2{{f(s.offset_m), f(1.0 / (s.scale * camera.depth_unit_m))}},
                max_shadow_px(camera), camera.depth.width, camera.depth.height, counts.handle());
  runtime.launch(measure_depth, depth_rays.grid, cl::NDRange(1, 1));
}

Renderer::Renderer(Runtime& runtime, const RgbdCamera& camera, std::uint64_t seed)
    : camera_(camera), seed_(seed), device_(std::make_unique<Device>(runtime, camera)) {}

Renderer::~Renderer() = default;

RgbdFrame Renderer::render(const Exposure& exposure, std::string_view stream, std::uint64_t number,
                           int samples_per_axis) {
  const auto words = RandomStream(seed_, stream).block(number);
  const cl_uint2 key{{words[0], words[1]}};
  device_->upload(camera_, exposure);
  device_->launch_color(camera_, exposure, key, samples_per_axis);
  device_->launch_depth(camera_, exposure, key);
  device_->launch_measurement(camera_);
  return {device_->runtime.download(device_->color), device_->runtime.download(device_->counts)};
}

}  // namespace touchtrace::scene
