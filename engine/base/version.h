#pragma once

namespace touchtrace {

inline constexpr const char* version = "0.1.0";

}  // namespace touchtrace
