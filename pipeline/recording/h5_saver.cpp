#include <fmt/core.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "pipeline/recording/h5_archive.h"

namespace touchtrace::h5 {
namespace {

/// `length`: 0 for a single value.
void write_attribute(hid_t object, const std::string& name, hid_t type, const void* value,
                     hsize_t length = 0) {
  const Handle space(length > 0 ? H5Screate_simple(1, &length, nullptr) : H5Screate(H5S_SCALAR),
                     H5Sclose, name);
  Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                   H5Aclose, name);
  check(H5Awrite(attribute, type, value), name);
  attribute.close(name);
}

void write_text(hid_t object, const std::string& name, const std::string& value) {
  const auto type = text_type(std::max<std::size_t>(1, value.size()));
  write_attribute(object, name, type.type, value.c_str());
}

std::vector<hsize_t> row_shape(const std::vector<Axis>& axes) {
  std::vector<hsize_t> shape;
  for (auto axis = axes.begin() + 1; axis != axes.end(); ++axis) shape.push_back(axis->length);
  return shape;
}

}  // namespace

Saver::Saver(Handle group) : group_(std::move(group)) {}

Saver Saver::group(const std::string& name) const {
  const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, name);
  check(H5Pset_obj_track_times(creation, false), name);
  return Saver(
      Handle(H5Gcreate2(group_, name.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose, name));
}

void Saver::attribute(const std::string& name, const std::string& value) {
  write_text(group_, name, value);
}

void Saver::attribute(const std::string& name, double value) {
  write_attribute(group_, name, H5T_IEEE_F64LE, &value);
}

void Saver::attribute(const std::string& name, std::int64_t value) {
  write_attribute(group_, name, H5T_STD_I64LE, &value);
}

void Saver::attribute(const std::string& name, const nlohmann::json& value) {
  write_text(group_, name, value.dump());
}

void Saver::attribute(const std::string& name, const std::vector<double>& values) {
  write_attribute(group_, name, H5T_IEEE_F64LE, values.data(),
                  values.size() > 1 ? values.size() : 0);
}

Axis Saver::axis(const std::string& name, std::size_t length) {
  std::vector<std::int32_t> indices(length);
  std::iota(indices.begin(), indices.end(), 0);
  return axis(name, indices, {"1", "index"});
}

Axis Saver::write_axis(const std::string& name, const ElementType& type,
                       std::span<const std::uint8_t> bytes, std::size_t length,
                       const DatasetInfo& info) {
  ArrayWriter writer(group_, name, type, {});
  writer.append(bytes);
  check(H5DSset_scale(writer.dataset(), name.c_str()), name);
  describe(writer.dataset(), {}, info);
  writer.close();
  scales_.emplace_back(H5Dopen2(group_, name.c_str(), H5P_DEFAULT), H5Dclose, name);
  return {name, length, scales_.back()};
}

void Saver::write(const std::string& name, const ElementType& type,
                  std::span<const std::uint8_t> bytes, const std::vector<Axis>& axes,
                  const DatasetInfo& info) {
  std::size_t expected_bytes = type.bytes;
  for (const auto& axis : axes) expected_bytes *= axis.length;
  if (bytes.size() != expected_bytes)
    throw H5Error(fmt::format("{}: expected {} bytes for its axes, found {}", name, expected_bytes,
                              bytes.size()));
  ArrayWriter writer(group_, name, type, row_shape(axes));
  writer.append(bytes);
  describe(writer.dataset(), axes, info);
  writer.close();
}

void Saver::describe(hid_t dataset, const std::vector<Axis>& axes, const DatasetInfo& info) {
  write_text(dataset, "units", info.units);
  write_text(dataset, "long_name", info.long_name);
  for (unsigned i = 0; i < axes.size(); ++i) {
    check(H5DSattach_scale(dataset, axes[i].scale, i), axes[i].name);
    check(H5DSset_label(dataset, i, axes[i].name.c_str()), axes[i].name);
  }
}

void Saver::describe_packing(hid_t dataset, double scale_factor) {
  const std::uint16_t missing = 0;
  write_attribute(dataset, "scale_factor", H5T_IEEE_F64LE, &scale_factor);
  write_attribute(dataset, "_FillValue", H5T_STD_U16LE, &missing);
}

void Saver::texts(const std::string& name, const std::vector<std::string>& values, const Axis& axis,
                  const DatasetInfo& info) {
  std::size_t longest = 1;
  for (const auto& value : values) longest = std::max(longest, value.size());
  std::vector<std::uint8_t> bytes(values.size() * longest);
  for (std::size_t i = 0; i < values.size(); ++i)
    std::memcpy(bytes.data() + i * longest, values[i].data(), values[i].size());
  write(name, text_type(longest), bytes, {axis}, info);
}

}  // namespace touchtrace::h5
