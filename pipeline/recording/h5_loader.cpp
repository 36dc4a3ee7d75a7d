#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "pipeline/recording/h5_archive.h"

namespace touchtrace::h5 {
namespace {

constexpr std::size_t max_text_bytes = 4096, max_attribute_bytes = 16 << 20;

Handle open_attribute(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0) throw H5Error("missing");
  Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, "cannot open it");
  const Handle space(H5Aget_space(attribute), H5Sclose, "cannot read its shape");
  if (H5Sget_simple_extent_type(space) != H5S_SCALAR)
    throw H5Error("expected a single value, found an array");
  return attribute;
}

/// Bytes of a fixed-length text type; throws for anything else.
std::size_t text_bytes(hid_t type, std::size_t max_bytes) {
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0)
    throw H5Error(fmt::format("expected text of fixed length, found {}", type_name(type)));
  const std::size_t bytes = H5Tget_size(type);
  if (bytes == 0 || bytes > max_bytes)
    throw H5Error(fmt::format("expected text of 1 to {} bytes, found {}", max_bytes, bytes));
  return bytes;
}

std::string until_zero(const char* text, std::size_t bytes) {
  return {text, std::find(text, text + bytes, '\0')};
}

std::string read_text(hid_t object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  const Handle type(H5Aget_type(attribute), H5Tclose, "cannot read its type");
  std::string value(text_bytes(type, max_attribute_bytes), '\0');
  check(H5Aread(attribute, type, value.data()), "cannot read it");
  return until_zero(value.data(), value.size());
}

template <class T>
void read_number(hid_t object, const std::string& name, T& value) {
  const Handle attribute = open_attribute(object, name);
  const Handle type(H5Aget_type(attribute), H5Tclose, "cannot read its type");
  require_type(type, element_type<T>());
  check(H5Aread(attribute, type, &value), "cannot read it");
}

void check_units(hid_t dataset, const char* expected) {
  std::string units;
  try {
    units = read_text(dataset, "units");
  } catch (const H5Error& fault) {
    throw H5Error(fmt::format("attribute 'units': {}", fault.what()));
  }
  if (units != expected)
    throw H5Error(fmt::format("expected units '{}', found '{}'", expected, units));
}

void check_shape(const std::vector<hsize_t>& shape, const std::vector<Axis>& axes) {
  const bool same = std::ranges::equal(shape, axes, [](hsize_t extent, const Axis& axis) {
    return axis.length == unknown_length || axis.length == extent;
  });
  if (same) return;
  std::vector<std::string> expected;
  for (const auto& axis : axes)
    expected.push_back(axis.length == unknown_length ? "any" : fmt::to_string(axis.length));
  throw H5Error(fmt::format("expected shape ({}), found ({})", fmt::join(expected, ", "),
                            fmt::join(shape, ", ")));
}

}  // namespace

Loader::Loader(Handle group, hsize_t file_bytes, std::string path, FileFaults& faults)
    : group_(std::move(group)), file_bytes_(file_bytes), path_(std::move(path)), faults_(&faults) {}

template <class Action>
bool Loader::record_fault(const std::string& path, Action action) const {
  if (group_ < 0) return false;
  try {
    action();
    return true;
  } catch (const H5Error& fault) {
    faults_->add(path, fault.what());
    return false;
  }
}

bool Loader::has(const std::string& name) const {
  return group_ >= 0 && H5Lexists(group_, name.c_str(), H5P_DEFAULT) > 0;
}

void Loader::check_link(const std::string& name, H5O_type_t type) const {
  const char* expected = type == H5O_TYPE_GROUP ? "group" : "dataset";
  if (!has(name)) throw H5Error(fmt::format("the {} is missing", expected));
  H5L_info_t link;
  check(H5Lget_info(group_, name.c_str(), &link, H5P_DEFAULT), "cannot read its link");
  if (link.type != H5L_TYPE_HARD)
    throw H5Error(fmt::format("expected a {}, found a link to another object or file", expected));
  H5O_info_t info;
  check(H5Oget_info_by_name2(group_, name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT),
        "cannot read its header");
  if (info.type != type)
    throw H5Error(fmt::format("expected a {}, found another object", expected));
}

Loader Loader::group(const std::string& name) const {
  Handle found;
  record_fault(path(name), [&] {
    check_link(name, H5O_TYPE_GROUP);
    found = Handle(H5Gopen2(group_, name.c_str(), H5P_DEFAULT), H5Gclose, "cannot open it");
  });
  return {std::move(found), file_bytes_, path(name), *faults_};
}

std::optional<ArrayReader> Loader::open(const std::string& name, const ElementType& type,
                                        const std::vector<Axis>& axes,
                                        const DatasetInfo& info) const {
  std::optional<ArrayReader> reader;
  const bool good = record_fault(path(name), [&] {
    check_link(name, H5O_TYPE_DATASET);
    reader.emplace(group_, name, type, file_bytes_);
    check_units(reader->dataset(), info.units);
    check_shape(reader->shape(), axes);
  });
  if (!good) reader.reset();
  return reader;
}

bool Loader::read_rows(const std::string& name, const ArrayReader& reader,
                       std::span<std::uint8_t> out) const {
  return record_fault(path(name), [&] { reader.read(0, out); });
}

void Loader::attribute(const std::string& name, std::string& value) const {
  record_fault(attribute_path(path_, name), [&] { value = read_text(group_, name); });
}

void Loader::attribute(const std::string& name, double& value) const {
  record_fault(attribute_path(path_, name), [&] {
    double found = 0.0;
    read_number(group_, name, found);
    if (!std::isfinite(found))
      throw H5Error(fmt::format("expected a finite number, found {}", found));
    value = found;
  });
}

void Loader::attribute(const std::string& name, std::int64_t& value) const {
  record_fault(attribute_path(path_, name), [&] { read_number(group_, name, value); });
}

void Loader::attribute(const std::string& name, int& value) const {
  value = -1;
  record_fault(attribute_path(path_, name), [&] {
    std::int64_t wide = 0;
    read_number(group_, name, wide);
    if (wide < std::numeric_limits<int>::min() || wide > std::numeric_limits<int>::max())
      throw H5Error(fmt::format("expected a number of 32 bits, found {}", wide));
    value = static_cast<int>(wide);
  });
}

void Loader::attribute(const std::string& name, nlohmann::json& value) const {
  record_fault(attribute_path(path_, name), [&] {
    value = nlohmann::json::parse(read_text(group_, name), nullptr, false);
    if (value.is_discarded()) throw H5Error("expected JSON, found other text");
  });
}

Axis Loader::axis(const std::string& name, std::size_t length) const {
  const auto reader = open(name, element_type<std::int32_t>(), {{name, length}}, {"1", ""});
  return {name, reader ? reader->rows() : unknown_length};
}

void Loader::texts(const std::string& name, std::vector<std::string>& values, const Axis& axis,
                   const DatasetInfo& info) const {
  ElementType type;
  const bool good = record_fault(path(name), [&] {
    check_link(name, H5O_TYPE_DATASET);
    const Handle dataset(H5Dopen2(group_, name.c_str(), H5P_DEFAULT), H5Dclose, "cannot open it");
    type.type = Handle(H5Dget_type(dataset), H5Tclose, "cannot read its type");
    type.bytes = text_bytes(type.type, max_text_bytes);
  });
  const auto reader = good ? open(name, type, {axis}, info) : std::nullopt;
  if (!reader) return;
  std::vector<std::uint8_t> text;
  read(name, *reader, text);
  for (std::size_t at = 0; at < text.size(); at += type.bytes)
    values.push_back(until_zero(reinterpret_cast<const char*>(text.data()) + at, type.bytes));
}

}  // namespace touchtrace::h5
