#include "pipeline/acquire/import/images/image_files.h"

namespace touchtrace {

ImportSource open_tum_source(const std::filesystem::path& folder, const SourceOptions&) {
  return {.color = color_file_stream(read_tum_list(folder, "rgb.txt")),
          .depth = depth_file_stream(read_tum_list(folder, "depth.txt")),
          .counts_per_m = tum_counts_per_m,
          .is_registered = true};
}

}  // namespace touchtrace
