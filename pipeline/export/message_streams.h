#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipeline/export/export.h"
#include "pipeline/export/ros2_messages.h"
#include "pipeline/recording/labels.h"

namespace touchtrace {

/// Messages of one topic, made one by one.
struct MessageStream {
  std::string topic;
  const RosType* type;
  std::string frame_id;
  std::vector<double> time_s;  ///< host clock, ascending
  std::function<std::string(const RosHeader& header, std::size_t index)> message;
};

struct MessageStreams {
  std::vector<MessageStream> streams;
  double epoch_unix_s = 0.0;  ///< Unix time of the host clock's 0; 0: unknown
};

/// Indices of the labels whose position was measured: neither lost nor outside the measured time.
std::vector<std::size_t> measured_labels(const LabelledBody& body);

/// Topics of labels, predictions and recording: README.md lists them. Throws data_error if there
/// are none.
MessageStreams open_streams(const ExportRequest& request);

}  // namespace touchtrace
