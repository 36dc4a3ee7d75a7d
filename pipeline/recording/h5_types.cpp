#include <fmt/core.h>

#include <bit>

#include "pipeline/recording/h5_array.h"

namespace touchtrace::h5 {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are copied without conversion");

ElementType copy_of(hid_t type, std::size_t bytes) {
  return {Handle(H5Tcopy(type), H5Tclose, "data type"), bytes};
}

}  // namespace

template <class T>
ElementType element_type() {
  ElementType result = copy_of(stored_type<T>(), sizeof(T));
  result.find_conversion = find_conversion<T>;
  return result;
}

template ElementType element_type<std::uint8_t>();
template ElementType element_type<std::uint16_t>();
template ElementType element_type<std::int32_t>();
template ElementType element_type<std::int64_t>();
template ElementType element_type<std::uint64_t>();
template ElementType element_type<float>();
template ElementType element_type<double>();

ElementType text_type(std::size_t bytes) {
  auto text = copy_of(H5T_C_S1, bytes);
  check(H5Tset_size(text.type, bytes), "text");
  check(H5Tset_strpad(text.type, H5T_STR_NULLPAD), "text");
  check(H5Tset_cset(text.type, H5T_CSET_UTF8), "text");
  return text;
}

std::string type_name(hid_t type) {
  const char* order = H5Tget_order(type) == H5T_ORDER_BE ? "big-endian " : "";
  const std::size_t bits = 8 * H5Tget_size(type);
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      return fmt::format("{}{}int{}", order, H5Tget_sign(type) == H5T_SGN_NONE ? "u" : "", bits);
    case H5T_FLOAT:
      return fmt::format("{}float{}", order, bits);
    case H5T_STRING:
      return H5Tis_variable_str(type) > 0 ? "variable-length text" : "fixed-length text";
    default:
      return "another type";
  }
}

}  // namespace touchtrace::h5
