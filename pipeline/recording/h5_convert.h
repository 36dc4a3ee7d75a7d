#pragma once

#include <hdf5.h>

#include <cstdint>
#include <span>

namespace touchtrace::h5 {

/// Converts stored elements to numbers in memory; both spans have the same number of elements.
/// Throws H5Error for a value that the memory's integer type cannot hold. Floats are rounded.
using Conversion = void (*)(std::span<const std::uint8_t> from, std::span<std::uint8_t> to);

/// Conversion from the data type `found` of a file (an integer, bool or float of either byte order)
/// to T. Throws H5Error for another type.
template <class T>
Conversion find_conversion(hid_t found);

}  // namespace touchtrace::h5
