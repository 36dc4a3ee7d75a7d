#include "pipeline/recording/h5_convert.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "pipeline/recording/h5_array.h"

namespace touchtrace::h5 {
namespace {

template <class To, class From>
bool can_hold(From value) {
  if constexpr (std::is_floating_point_v<To>) {
    return true;
  } else if constexpr (std::is_integral_v<From>) {
    return std::in_range<To>(value);
  } else {  // 2^digits is the first number beyond To and exact in floating point
    return value == std::trunc(value) &&
           value >= static_cast<From>(std::numeric_limits<To>::min()) &&
           value < std::ldexp(From(1), std::numeric_limits<To>::digits);
  }
}

template <class From, bool swapped>
From load(const std::uint8_t* bytes) {
  std::array<std::uint8_t, sizeof(From)> copy;
  std::copy_n(bytes, sizeof(From), copy.begin());
  if constexpr (swapped) std::ranges::reverse(copy);
  return std::bit_cast<From>(copy);
}

template <class To, class From, bool swapped>
void convert(std::span<const std::uint8_t> from, std::span<std::uint8_t> to) {
  for (std::size_t i = 0; i < to.size() / sizeof(To); ++i) {
    const From value = load<From, swapped>(from.data() + i * sizeof(From));
    if (!can_hold<To>(value))
      throw H5Error(fmt::format("expected whole numbers from {} to {}, found {}",
                                std::numeric_limits<To>::min(), std::numeric_limits<To>::max(),
                                value));
    const To result = static_cast<To>(value);
    std::memcpy(to.data() + i * sizeof(To), &result, sizeof(To));
  }
}

template <class To, class From>
bool match(hid_t found, Conversion& conversion) {
  const Handle big_endian(H5Tcopy(stored_type<From>()), H5Tclose, "data type");
  check(H5Tset_order(big_endian, H5T_ORDER_BE), "data type");
  if (H5Tequal(found, stored_type<From>()) > 0)
    conversion = convert<To, From, false>;
  else if (H5Tequal(found, big_endian) > 0)
    conversion = convert<To, From, true>;
  return conversion != nullptr;
}

}  // namespace

template <class T>
Conversion find_conversion(hid_t found) {
  if (H5Tget_class(found) == H5T_ENUM)  // bool of h5py
    return find_conversion<T>(Handle(H5Tget_super(found), H5Tclose, "cannot read its type"));
  Conversion conversion = nullptr;
  const bool is_known =
      match<T, std::uint8_t>(found, conversion) || match<T, std::uint16_t>(found, conversion) ||
      match<T, std::int8_t>(found, conversion) || match<T, std::int16_t>(found, conversion) ||
      match<T, std::int32_t>(found, conversion) || match<T, std::uint32_t>(found, conversion) ||
      match<T, std::int64_t>(found, conversion) || match<T, std::uint64_t>(found, conversion) ||
      match<T, float>(found, conversion) || match<T, double>(found, conversion);
  if (!is_known)
    throw H5Error(
        fmt::format("expected integers or floats of 32 or 64 bits, found {}", type_name(found)));
  return conversion;
}

template Conversion find_conversion<std::uint8_t>(hid_t);
template Conversion find_conversion<std::uint16_t>(hid_t);
template Conversion find_conversion<std::int32_t>(hid_t);
template Conversion find_conversion<std::int64_t>(hid_t);
template Conversion find_conversion<std::uint64_t>(hid_t);
template Conversion find_conversion<float>(hid_t);
template Conversion find_conversion<double>(hid_t);

}  // namespace touchtrace::h5
