#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace touchtrace {

/// File in a zip archive.
struct ZipEntry {
  std::string name;
  int method = 0;  ///< 0: stored, 8: deflated
  std::uint32_t stored_bytes = 0, bytes = 0, local_header = 0;
};

/// Entries of an archive's central directory. Throws std::exception for an invalid archive.
std::vector<ZipEntry> zip_entries(const std::string& archive);

/// Content of an entry. Throws std::exception if it is damaged or compressed by another method.
std::string zip_content(const std::string& archive, const ZipEntry& entry);

}  // namespace touchtrace
