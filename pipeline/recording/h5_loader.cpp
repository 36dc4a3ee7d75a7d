#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/recording/h5_archive.h"

namespace touchtrace::h5 {
namespace {

constexpr std::size_t longest_text = 4096, longest_attribute = 16 << 20;

Handle open_attribute(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0)
    throw H5Error(fmt::format("attribute '{}' is missing", name));
  Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, name);
  const Handle space(H5Aget_space(attribute), H5Sclose, name);
  if (H5Sget_simple_extent_type(space) != H5S_SCALAR)
    throw H5Error(fmt::format("attribute '{}' is no single value", name));
  return attribute;
}

/// Bytes of a fixed-length text type; throws for anything else.
std::size_t text_bytes(hid_t type, const std::string& name, std::size_t longest) {
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0)
    throw H5Error(fmt::format("{} is no text of fixed length", name));
  const std::size_t bytes = H5Tget_size(type);
  if (bytes == 0 || bytes > longest) throw H5Error(fmt::format("{} is too long", name));
  return bytes;
}

std::string until_zero(const char* text, std::size_t bytes) {
  return {text, std::find(text, text + bytes, '\0')};
}

std::string read_text(hid_t object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  const Handle type(H5Aget_type(attribute), H5Tclose, name);
  std::string value(text_bytes(type, name, longest_attribute), '\0');
  check(H5Aread(attribute, type, value.data()), name);
  return until_zero(value.data(), value.size());
}

template <class T>
void read_number(hid_t object, const std::string& name, T& value) {
  const Handle attribute = open_attribute(object, name);
  const Handle type(H5Aget_type(attribute), H5Tclose, name);
  const auto expected = element_type<T>();
  if (H5Tequal(type, expected.type) <= 0)
    throw H5Error(fmt::format("attribute '{}' has another type than it should", name));
  check(H5Aread(attribute, expected.type, &value), name);
}

}  // namespace

Loader::Loader(Handle group, hsize_t file_bytes)
    : group_(std::move(group)), file_bytes_(file_bytes) {}

bool Loader::has(const std::string& name) const {
  return H5Lexists(group_, name.c_str(), H5P_DEFAULT) > 0;
}

void Loader::check_link(const std::string& name, H5O_type_t type) const {
  if (!has(name)) throw H5Error(fmt::format("'{}' is missing", name));
  H5L_info_t link;
  check(H5Lget_info(group_, name.c_str(), &link, H5P_DEFAULT), name);
  if (link.type != H5L_TYPE_HARD) throw H5Error(fmt::format("'{}' is a link to elsewhere", name));
  H5O_info_t info;
  check(H5Oget_info_by_name2(group_, name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT), name);
  if (info.type != type)
    throw H5Error(fmt::format("'{}' is no {}", name, type == H5O_TYPE_GROUP ? "group" : "dataset"));
}

Loader Loader::group(const std::string& name) const {
  check_link(name, H5O_TYPE_GROUP);
  return {Handle(H5Gopen2(group_, name.c_str(), H5P_DEFAULT), H5Gclose, name), file_bytes_};
}

ArrayReader Loader::open(const std::string& name, const ElementType& type,
                         const Meaning& meaning) const {
  check_link(name, H5O_TYPE_DATASET);
  ArrayReader reader(group_, name, type, file_bytes_);
  if (const auto units = read_text(reader.dataset(), "units"); units != meaning.units)
    throw H5Error(fmt::format("'{}' is in '{}', not in '{}'", name, units, meaning.units));
  return reader;
}

void Loader::check_shape(const std::string& name, const ArrayReader& reader,
                         const std::vector<Axis>& axes) const {
  std::vector<hsize_t> expected;
  for (const auto& axis : axes) expected.push_back(axis.length);
  if (reader.shape() != expected)
    throw H5Error(fmt::format("'{}' has another shape than its axes", name));
}

void Loader::attribute(const std::string& name, std::string& value) const {
  value = read_text(group_, name);
}

void Loader::attribute(const std::string& name, double& value) const {
  read_number(group_, name, value);
  if (!std::isfinite(value)) throw H5Error(fmt::format("attribute '{}' is not finite", name));
}

void Loader::attribute(const std::string& name, std::int64_t& value) const {
  read_number(group_, name, value);
}

void Loader::attribute(const std::string& name, int& value) const {
  std::int64_t wide = 0;
  attribute(name, wide);
  if (wide < std::numeric_limits<int>::min() || wide > std::numeric_limits<int>::max())
    throw H5Error(fmt::format("attribute '{}' is out of range", name));
  value = static_cast<int>(wide);
}

void Loader::attribute(const std::string& name, nlohmann::json& value) const {
  value = nlohmann::json::parse(read_text(group_, name), nullptr, false);
  if (value.is_discarded()) throw H5Error(fmt::format("attribute '{}' is no JSON", name));
}

Axis Loader::axis(const std::string& name, std::size_t length) const {
  const ArrayReader reader = open(name, element_type<std::int32_t>(), {"1", ""});
  if (reader.shape().size() != 1 || reader.rows() != length)
    throw H5Error(fmt::format("axis '{}' has the wrong length", name));
  return {name, reader.rows()};
}

void Loader::texts(const std::string& name, std::vector<std::string>& values, const Axis& axis,
                   const Meaning& meaning) const {
  check_link(name, H5O_TYPE_DATASET);
  const Handle dataset(H5Dopen2(group_, name.c_str(), H5P_DEFAULT), H5Dclose, name);
  ElementType type{Handle(H5Dget_type(dataset), H5Tclose, name), 0};
  const std::size_t bytes = type.bytes = text_bytes(type.type, name, longest_text);
  const ArrayReader reader = open(name, type, meaning);
  check_shape(name, reader, {axis});
  std::vector<std::uint8_t> text;
  read_into(reader, text);
  values.clear();
  for (std::size_t i = 0; i < axis.length; ++i)
    values.push_back(until_zero(reinterpret_cast<const char*>(text.data()) + i * bytes, bytes));
}

}  // namespace touchtrace::h5
