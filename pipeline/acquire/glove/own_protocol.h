#pragma once

#include <filesystem>

#include "pipeline/acquire/glove/protocol.h"

namespace touchtrace {

/// Reads the protocol of a glove of one's own: packets of a fixed length, one for each frame.
/// pipeline/acquire/README.md describes the file. Throws data_error for an invalid one.
GloveProtocol read_glove_protocol(const std::filesystem::path& file);

}  // namespace touchtrace
