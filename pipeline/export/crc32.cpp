#include <libdeflate.h>

#include "pipeline/export/byte_writer.h"

namespace touchtrace {

std::uint32_t crc32(std::string_view bytes, std::uint32_t crc) {
  return libdeflate_crc32(crc, bytes.data(), bytes.size());
}

}  // namespace touchtrace
