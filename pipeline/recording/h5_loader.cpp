#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/finite.h"
#include "pipeline/recording/h5_archive.h"

namespace touchtrace::h5 {
namespace {

constexpr std::size_t max_text_bytes = 4096, max_attribute_bytes = 16 << 20;
constexpr hssize_t max_attribute_numbers = 4096;

/// Opens an attribute of 1 to `max_values` values.
Handle open_attribute(hid_t object, const std::string& name, hssize_t max_values, hssize_t& count) {
  if (H5Aexists(object, name.c_str()) <= 0) throw H5Error("missing");
  Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, "cannot open it");
  const Handle space(H5Aget_space(attribute), H5Sclose, "cannot read its shape");
  count = H5Sget_simple_extent_npoints(space);
  if (count < 1 || count > max_values)
    throw H5Error(max_values == 1
                      ? fmt::format("expected a single value, found {} values", count)
                      : fmt::format("expected 1 to {} values, found {}", max_values, count));
  return attribute;
}

/// Throws unless `type` is text; returns its bytes, those of a pointer if its length is variable.
std::size_t text_bytes(hid_t type, std::size_t max_bytes) {
  if (H5Tget_class(type) != H5T_STRING)
    throw H5Error(fmt::format("expected text, found {}", type_name(type)));
  const std::size_t bytes = H5Tget_size(type);
  if (bytes == 0 || bytes > max_bytes)
    throw H5Error(fmt::format("expected text of 1 to {} bytes, found {}", max_bytes, bytes));
  return bytes;
}

bool is_variable(hid_t text_type) { return H5Tis_variable_str(text_type) > 0; }

std::string until_zero(const char* text, std::size_t bytes) {
  return {text, std::find(text, text + bytes, '\0')};
}

std::string read_text(hid_t object, const std::string& name) {
  hssize_t count = 0;
  const Handle attribute = open_attribute(object, name, 1, count);
  const Handle type(H5Aget_type(attribute), H5Tclose, "cannot read its type");
  const std::size_t bytes = text_bytes(type, max_attribute_bytes);
  if (is_variable(type)) {
    char* text = nullptr;
    check(H5Aread(attribute, type, &text), "cannot read it");
    const std::string value = text != nullptr ? text : "";
    H5free_memory(text);
    return value;
  }
  std::string value(bytes, '\0');
  check(H5Aread(attribute, type, value.data()), "cannot read it");
  return until_zero(value.data(), value.size());
}

/// Numbers of a JSON array of any nesting.
void append_numbers(const nlohmann::json& json, std::vector<double>& numbers) {
  if (json.is_array())
    for (const auto& item : json) append_numbers(item, numbers);
  else if (json.is_number())
    numbers.push_back(json.get<double>());
  else
    throw H5Error(fmt::format("expected numbers, found {:.40}", json.dump()));
}

std::vector<double> numbers_of_text(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  std::vector<double> numbers;
  append_numbers(json.is_discarded() ? nlohmann::json(text) : json, numbers);
  return numbers;
}

std::vector<double> read_numbers(hid_t object, const std::string& name) {
  hssize_t count = 0;
  const Handle attribute = open_attribute(object, name, max_attribute_numbers, count);
  const Handle type(H5Aget_type(attribute), H5Tclose, "cannot read its type");
  if (H5Tget_class(type) == H5T_STRING) return numbers_of_text(read_text(object, name));
  const Conversion convert = find_conversion<double>(type);
  std::vector<std::uint8_t> stored(static_cast<std::size_t>(count) * H5Tget_size(type));
  check(H5Aread(attribute, type, stored.data()), "cannot read it");
  std::vector<double> numbers(static_cast<std::size_t>(count));
  convert(stored, bytes_of(numbers));
  return numbers;
}

double read_number(hid_t object, const std::string& name) {
  const auto numbers = read_numbers(object, name);
  if (numbers.size() != 1)
    throw H5Error(fmt::format("expected a single number, found {}", numbers.size()));
  return numbers[0];
}

void check_units(hid_t dataset, const char* expected) {
  if (H5Aexists(dataset, "units") <= 0) return;
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

std::vector<std::string> variable_texts(const ArrayReader& reader, hid_t type) {
  std::vector<char*> texts(reader.rows(), nullptr);
  check(H5Dread(reader.dataset(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()),
        "cannot read it");
  std::vector<std::string> values;
  for (char* text : texts) {
    values.emplace_back(text != nullptr ? text : "");
    H5free_memory(text);
  }
  return values;
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

bool Loader::has_attribute(const std::string& name) const {
  return group_ >= 0 && H5Aexists(group_, name.c_str()) > 0;
}

std::vector<hsize_t> Loader::shape(const std::string& name) const {
  std::vector<hsize_t> extents;
  if (!has(name)) return extents;
  record_fault(path(name), [&] {
    check_link(name, H5O_TYPE_DATASET);
    const Handle dataset(H5Dopen2(group_, name.c_str(), H5P_DEFAULT), H5Dclose, "cannot open it");
    extents = extents_of(Handle(H5Dget_space(dataset), H5Sclose, "cannot read its shape"));
  });
  return extents;
}

bool Loader::is_float(const std::string& name) const {
  bool result = false;
  record_fault(path(name), [&] {
    check_link(name, H5O_TYPE_DATASET);
    const Handle dataset(H5Dopen2(group_, name.c_str(), H5P_DEFAULT), H5Dclose, "cannot open it");
    const Handle type(H5Dget_type(dataset), H5Tclose, "cannot read its type");
    result = H5Tget_class(type) == H5T_FLOAT;
  });
  return result;
}

Loader Loader::optional_group(const std::string& name) const {
  if (has(name)) return group(name);
  return {Handle(), file_bytes_, path(name), *faults_};
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
                                        const std::vector<Axis>& axes, const DatasetInfo& info,
                                        ArrayReader::Unwritten unwritten) const {
  std::optional<ArrayReader> reader;
  const bool good = record_fault(path(name), [&] {
    check_link(name, H5O_TYPE_DATASET);
    reader.emplace(group_, name, type, file_bytes_, unwritten);
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
    const double found = read_number(group_, name);
    if (!std::isfinite(found))
      throw H5Error(fmt::format("expected a finite number, found {}", found));
    value = found;
  });
}

void Loader::attribute(const std::string& name, int& value) const {
  value = -1;
  record_fault(attribute_path(path_, name), [&] {
    const double wide = read_number(group_, name);
    if (wide != std::trunc(wide) || std::abs(wide) > std::numeric_limits<int>::max())
      throw H5Error(fmt::format("expected a whole number of 32 bits, found {}", wide));
    value = static_cast<int>(wide);
  });
}

void Loader::attribute(const std::string& name, std::vector<double>& values) const {
  record_fault(attribute_path(path_, name), [&] {
    auto found = read_numbers(group_, name);
    if (!all_finite(found))
      throw H5Error(fmt::format("expected finite numbers, found {}", fmt::join(found, " ")));
    values = std::move(found);
  });
}

void Loader::attribute(const std::string& name, nlohmann::json& value) const {
  record_fault(attribute_path(path_, name), [&] {
    value = nlohmann::json::parse(read_text(group_, name), nullptr, false);
    if (value.is_discarded()) throw H5Error("expected JSON, found other text");
  });
}

ElementType Loader::text_type_of(const std::string& name) const {
  check_link(name, H5O_TYPE_DATASET);
  const Handle dataset(H5Dopen2(group_, name.c_str(), H5P_DEFAULT), H5Dclose, "cannot open it");
  Handle type(H5Dget_type(dataset), H5Tclose, "cannot read its type");
  const std::size_t bytes = text_bytes(type, max_text_bytes);
  return {std::move(type), bytes};
}

void Loader::texts(const std::string& name, std::vector<std::string>& values, const Axis& axis,
                   const DatasetInfo& info) const {
  ElementType type;
  const bool good = record_fault(path(name), [&] { type = text_type_of(name); });
  const auto reader = good ? open(name, type, {axis}, info) : std::nullopt;
  if (!reader) return;
  if (is_variable(type.type)) {
    record_fault(path(name), [&] { values = variable_texts(*reader, type.type); });
    return;
  }
  std::vector<std::uint8_t> text;
  read(name, *reader, text);
  for (std::size_t at = 0; at < text.size(); at += type.bytes)
    values.push_back(until_zero(reinterpret_cast<const char*>(text.data()) + at, type.bytes));
}

}  // namespace touchtrace::h5
