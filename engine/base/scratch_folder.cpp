#include "engine/base/scratch_folder.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "engine/base/error.h"

namespace touchtrace {

ScratchFolder::ScratchFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "touchtrace-XXXXXX").string();
  if (!mkdtemp(pattern.data()))
    throw failure(fmt::format("cannot create a folder {}: {}", pattern, std::strerror(errno)),
                  "free space there or set TMPDIR to a writable folder");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace touchtrace
