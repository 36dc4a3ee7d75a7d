#pragma once

#include <hdf5.h>

#include <cstdint>
#include <span>
#include <type_traits>

namespace touchtrace::h5 {

/// Converts stored elements to numbers in memory; both spans have the same number of elements.
/// Throws H5Error for a value that the memory's integer type cannot hold. Floats are rounded.
using Conversion = void (*)(std::span<const std::uint8_t> from, std::span<std::uint8_t> to);

/// Little-endian data type of a file for numbers of type T.
template <class T>
hid_t stored_type() {
  if constexpr (std::is_same_v<T, std::int8_t>) return H5T_STD_I8LE;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_STD_U8LE;
  if constexpr (std::is_same_v<T, std::int16_t>) return H5T_STD_I16LE;
  if constexpr (std::is_same_v<T, std::uint16_t>) return H5T_STD_U16LE;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_STD_I32LE;
  if constexpr (std::is_same_v<T, std::uint32_t>) return H5T_STD_U32LE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_STD_I64LE;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_STD_U64LE;
  if constexpr (std::is_same_v<T, float>) return H5T_IEEE_F32LE;
  if constexpr (std::is_same_v<T, double>) return H5T_IEEE_F64LE;
}

/// Conversion from the data type `found` of a file (an integer, bool or float of either byte order)
/// to T. Throws H5Error for another type.
template <class T>
Conversion find_conversion(hid_t found);

}  // namespace touchtrace::h5
