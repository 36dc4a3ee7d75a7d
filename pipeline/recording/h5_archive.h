#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "pipeline/recording/file_faults.h"
#include "pipeline/recording/h5_array.h"

namespace touchtrace::h5 {

inline constexpr std::size_t unknown_length = std::numeric_limits<std::size_t>::max();

/// Named dimension of a group, stored as an HDF5 dimension scale.
struct Axis {
  std::string name;
  std::size_t length = unknown_length;  ///< unknown while loading if its dataset has a fault
  hid_t scale = H5I_INVALID_HID;        ///< only while saving
};

/// Attributes `units` and `long_name` of a dataset.
struct DatasetInfo {
  const char* units;  ///< UDUNITS; "1": dimensionless
  const char* long_name;
};

template <class T>
std::span<const std::uint8_t> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}
template <class T>
std::span<std::uint8_t> bytes_of(std::vector<T>& values) {
  return {reinterpret_cast<std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

/// Writes a group. Saver and Loader share the member functions that `serialize(archive, value)`
/// uses, so that one template per struct writes and reads it. Throws H5Error.
class Saver {
 public:
  explicit Saver(Handle group);

  Saver group(const std::string& name) const;
  hid_t id() const { return group_; }

  void attribute(const std::string& name, const std::string& value);
  void attribute(const std::string& name, double value);
  void attribute(const std::string& name, std::int64_t value);
  void attribute(const std::string& name, int value) { attribute(name, std::int64_t{value}); }
  void attribute(const std::string& name, const nlohmann::json& value);
  /// One value is written as a scalar.
  void attribute(const std::string& name, const std::vector<double>& values);
  /// Writes nothing if the value is empty.
  template <class T>
  void optional_attribute(const std::string& name, const T& value) {
    if constexpr (std::is_arithmetic_v<T>)
      attribute(name, value);
    else if (!value.empty())
      attribute(name, value);
  }

  /// Axis whose scale is the index 0 .. length - 1.
  Axis axis(const std::string& name, std::size_t length);
  /// Axis whose scale is `values`.
  template <class T>
  Axis axis(const std::string& name, const std::vector<T>& values, const DatasetInfo& info) {
    return write_axis(name, element_type<T>(), bytes_of(values), values.size(), info);
  }
  /// Row-major array over `axes`.
  template <class T>
  void array(const std::string& name, const std::vector<T>& values, const std::vector<Axis>& axes,
             const DatasetInfo& info) {
    write(name, element_type<T>(), bytes_of(values), axes, info);
  }
  /// Writes nothing if there are no values.
  template <class T>
  void optional_array(const std::string& name, const std::vector<T>& values,
                      const std::vector<Axis>& axes, const DatasetInfo& info) {
    if (!values.empty()) array(name, values, axes, info);
  }
  void texts(const std::string& name, const std::vector<std::string>& values, const Axis& axis,
             const DatasetInfo& info);
  /// Writes the texts also if there are none.
  void optional_texts(const std::string& name, const std::vector<std::string>& values,
                      const Axis& axis, const DatasetInfo& info) {
    texts(name, values, axis, info);
  }
  /// Attaches units, long_name and dimension scales to a dataset of this group.
  static void describe(hid_t dataset, const std::vector<Axis>& axes, const DatasetInfo& info);
  /// Attaches the packing of the CF conventions: value = scale_factor * count; count 0: missing.
  static void describe_packing(hid_t dataset, double scale_factor);

 private:
  Axis write_axis(const std::string& name, const ElementType& type,
                  std::span<const std::uint8_t> bytes, std::size_t length, const DatasetInfo& info);
  void write(const std::string& name, const ElementType& type, std::span<const std::uint8_t> bytes,
             const std::vector<Axis>& axes, const DatasetInfo& info);

  Handle group_;
  std::vector<Handle> scales_;
};

/// Reads and checks a group of an untrusted file. Types are converted where that loses nothing,
/// text may have fixed or variable length, and units and dimension scales may be missing. Faults of
/// groups, datasets and attributes are recorded, not thrown, and reading continues, so that all
/// faults of a file are found at once. Whoever opened the file calls FileFaults::throw_if_any
/// before the values are used.
class Loader {
 public:
  /// `path`: of the group within the file, empty for the root. `faults` must outlive the Loader.
  Loader(Handle group, hsize_t file_bytes, std::string path, FileFaults& faults);

  /// A missing group is a fault; all reads from it are then skipped.
  Loader group(const std::string& name) const;
  /// Like group(), but a missing group is not a fault.
  Loader optional_group(const std::string& name) const;
  bool has(const std::string& name) const;
  bool has_attribute(const std::string& name) const;
  /// Shape of a dataset; empty if it is missing or not an array.
  std::vector<hsize_t> shape(const std::string& name) const;
  bool is_float(const std::string& dataset) const;
  const std::string& path() const { return path_; }
  std::string path(const std::string& name) const { return path_ + "/" + name; }
  FileFaults& faults() const { return *faults_; }

  /// A faulty attribute leaves `value` as it is; a faulty int becomes -1.
  void attribute(const std::string& name, std::string& value) const;
  void attribute(const std::string& name, double& value) const;
  void attribute(const std::string& name, int& value) const;
  void attribute(const std::string& name, nlohmann::json& value) const;
  /// Numbers, of any shape.
  void attribute(const std::string& name, std::vector<double>& values) const;
  /// Leaves `value` as it is if the attribute is missing.
  template <class T>
  void optional_attribute(const std::string& name, T& value) const {
    if (has_attribute(name)) attribute(name, value);
  }

  /// Axis of this length; a length of -1 (a faulty attribute) is not checked.
  Axis axis(const std::string& name, std::size_t length) const { return {name, length}; }
  template <class T>
  Axis axis(const std::string& name, std::vector<T>& values, const DatasetInfo& info) const {
    array(name, values, {{name, unknown_length}}, info);
    return {name, faults_->contains(path(name)) ? unknown_length : values.size()};
  }
  /// A faulty array leaves `values` empty.
  template <class T>
  void array(const std::string& name, std::vector<T>& values, const std::vector<Axis>& axes,
             const DatasetInfo& info) const {
    if (const auto reader = open(name, element_type<T>(), axes, info)) read(name, *reader, values);
  }
  /// Array whose writer grew it in blocks: what was never written is zero.
  template <class T>
  void padded_array(const std::string& name, std::vector<T>& values, const std::vector<Axis>& axes,
                    const DatasetInfo& info) const {
    if (const auto reader =
            open(name, element_type<T>(), axes, info, ArrayReader::Unwritten::zeros))
      read(name, *reader, values);
  }
  /// Leaves `values` as they are if the array is missing.
  template <class T>
  void optional_array(const std::string& name, std::vector<T>& values,
                      const std::vector<Axis>& axes, const DatasetInfo& info) const {
    if (has(name)) array(name, values, axes, info);
  }
  void texts(const std::string& name, std::vector<std::string>& values, const Axis& axis,
             const DatasetInfo& info) const;
  void optional_texts(const std::string& name, std::vector<std::string>& values, const Axis& axis,
                      const DatasetInfo& info) const {
    if (has(name)) texts(name, values, axis, info);
  }
  /// Opens a dataset after checking that it is one, stored in this file, of this shape and unit,
  /// with elements that convert to this type. nullopt if it has a fault.
  std::optional<ArrayReader> open(
      const std::string& name, const ElementType& type, const std::vector<Axis>& axes,
      const DatasetInfo& info,
      ArrayReader::Unwritten unwritten = ArrayReader::Unwritten::faults) const;

 private:
  template <class T>
  void read(const std::string& name, const ArrayReader& reader, std::vector<T>& values) const {
    values.resize(reader.rows() * reader.row_bytes() / sizeof(T));
    if (!read_rows(name, reader, bytes_of(values))) values.clear();
  }
  bool read_rows(const std::string& name, const ArrayReader& reader,
                 std::span<std::uint8_t> out) const;
  /// Runs `action`; an H5Error becomes a fault of the object at `path`. True if there was none.
  template <class Action>
  bool record_fault(const std::string& path, Action action) const;
  void check_link(const std::string& name, H5O_type_t type) const;
  ElementType text_type_of(const std::string& name) const;

  Handle group_;  ///< invalid if the group has a fault
  hsize_t file_bytes_;
  std::string path_;
  FileFaults* faults_;
};

}  // namespace touchtrace::h5
