#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pipeline/acquire/import/source/source.h"
#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Stamps from it on are Unix times.
inline constexpr double min_unix_s = 1e8;

struct ImageFormat {
  cv::Size size;
  int type = 0;  ///< of cv::Mat
};

/// Copies the images of one stream to a recording. Images that are damaged or of another format are
/// reported and skipped.
class StreamCopy {
 public:
  using Append = std::function<void(const cv::Mat& image)>;

  /// `clock_start_s`: time of the source that is 0 in the recording.
  StreamCopy(const SourceStream& stream, const ImageFormat& format, double clock_start_s,
             Append append);

  bool is_finished() const { return next_ == stream_.images.size(); }
  double next_time_s() const { return stream_.images[next_].host_time_s; }
  void copy_next();

  /// Stamps of the copied images, with the frame_counter() of their names or else their index in
  /// the source as sequence. Device times that run backward are replaced by the host's.
  CameraTimes times() const;
  /// Index in the recording by index in the source.
  const std::map<std::size_t, std::size_t>& copied() const { return copied_; }
  std::size_t num_skipped() const { return next_ - copied_.size(); }
  /// Copied images whose pixels equal those of the one before.
  std::size_t num_repeated() const { return num_repeated_; }

 private:
  void skip(const std::string& fault);

  const SourceStream& stream_;
  ImageFormat format_;
  double clock_start_s_;
  Append append_;
  std::vector<std::uint64_t> frame_counter_;  ///< of the source's images; empty: their index
  std::size_t next_ = 0;
  std::map<std::size_t, std::size_t> copied_;
  cv::Mat last_;
  std::size_t num_repeated_ = 0;
};

}  // namespace touchtrace
