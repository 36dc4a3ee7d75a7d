#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "pipeline/recording/h5_array.h"

namespace touchtrace::h5 {

/// A named dimension of a group, with its dimension scale.
struct Axis {
  std::string name;
  std::size_t length;
  hid_t scale = H5I_INVALID_HID;  ///< only while saving
};

/// What a dataset says about itself.
struct Meaning {
  const char* units;  ///< UDUNITS; "1" for counts and numbers
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

/// `Saver` and `Loader` have the same member functions, so one `exchange(archive, value)` describes
/// both how a struct is written and how it is read and checked. Both throw H5Error.
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

  /// A dimension that is only counted.
  Axis axis(const std::string& name, std::size_t length);
  /// A dimension whose scale holds values.
  template <class T>
  Axis axis(const std::string& name, const std::vector<T>& values, const Meaning& meaning) {
    return write_axis(name, element_type<T>(), bytes_of(values), values.size(), meaning);
  }
  template <class T>
  void array(const std::string& name, const std::vector<T>& values, const std::vector<Axis>& axes,
             const Meaning& meaning) {
    write(name, element_type<T>(), bytes_of(values), axes, meaning);
  }
  void texts(const std::string& name, const std::vector<std::string>& values, const Axis& axis,
             const Meaning& meaning);
  /// Hangs meaning and dimension scales on a dataset of this group.
  static void describe(hid_t dataset, const std::vector<Axis>& axes, const Meaning& meaning);
  /// CF's packing of counts: metres = scale_factor * count, 0 is missing.
  static void describe_packing(hid_t dataset, double scale_factor);

 private:
  Axis write_axis(const std::string& name, const ElementType& type,
                  std::span<const std::uint8_t> bytes, std::size_t length, const Meaning& meaning);
  void write(const std::string& name, const ElementType& type, std::span<const std::uint8_t> bytes,
             const std::vector<Axis>& axes, const Meaning& meaning);

  Handle group_;
  std::vector<Handle> scales_;
};

class Loader {
 public:
  Loader(Handle group, hsize_t file_bytes);

  Loader group(const std::string& name) const;
  bool has(const std::string& name) const;
  hid_t id() const { return group_; }
  hsize_t file_bytes() const { return file_bytes_; }

  void attribute(const std::string& name, std::string& value) const;
  void attribute(const std::string& name, double& value) const;
  void attribute(const std::string& name, std::int64_t& value) const;
  void attribute(const std::string& name, int& value) const;
  void attribute(const std::string& name, nlohmann::json& value) const;

  /// A counted dimension, which has to have this length.
  Axis axis(const std::string& name, std::size_t length) const;
  template <class T>
  Axis axis(const std::string& name, std::vector<T>& values, const Meaning& meaning) const {
    const ArrayReader reader = open(name, element_type<T>(), meaning);
    read_into(reader, values);
    return {name, values.size()};
  }
  template <class T>
  void array(const std::string& name, std::vector<T>& values, const std::vector<Axis>& axes,
             const Meaning& meaning) const {
    const ArrayReader reader = open(name, element_type<T>(), meaning);
    check_shape(name, reader, axes);
    read_into(reader, values);
  }
  void texts(const std::string& name, std::vector<std::string>& values, const Axis& axis,
             const Meaning& meaning) const;
  /// Opens a dataset of this group after checking that it is one, stored in this file, in these
  /// units.
  ArrayReader open(const std::string& name, const ElementType& type, const Meaning& meaning) const;
  void check_shape(const std::string& name, const ArrayReader& reader,
                   const std::vector<Axis>& axes) const;

 private:
  template <class T>
  static void read_into(const ArrayReader& reader, std::vector<T>& values) {
    values.resize(reader.rows() * reader.row_bytes() / sizeof(T));
    reader.read(0, bytes_of(values));
  }
  void check_link(const std::string& name, H5O_type_t type) const;

  Handle group_;
  hsize_t file_bytes_;
};

}  // namespace touchtrace::h5
