#include "pipeline/export/tables.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "pipeline/dataset/tactile_image.h"
#include "pipeline/export/predictions.h"
#include "pipeline/recording/labels.h"
#include "pipeline/recording/recording_file.h"

namespace touchtrace {
namespace {

const AxisNames xyz{"x", "y", "z"}, state_axis{"x", "y", "z", "vx", "vy", "vz"};

AxisNames numbered_axis(int length) {
  AxisNames names;
  for (int i = 0; i < length; ++i) names.push_back(std::to_string(i));
  return names;
}

void append_body(DataTable& table, const std::string& name, LabelledBody& body) {
  auto& arrays = table.arrays;
  arrays.push_back({name + "_position_m", std::move(body.position_m), {xyz}});
  arrays.push_back({name + "_velocity_m_per_s", std::move(body.velocity_m_per_s), {xyz}});
  arrays.push_back({name + "_covariance", std::move(body.covariance), {state_axis, state_axis}});
  arrays.push_back({name + "_causal_position_m", std::move(body.causal_position_m), {xyz}});
  arrays.push_back(
      {name + "_causal_velocity_m_per_s", std::move(body.causal_velocity_m_per_s), {xyz}});
  arrays.push_back({name + "_quality", std::move(body.quality)});
}

DataTable table_of_clips(const std::vector<Clip>& clips) {
  std::vector<double> start_s, end_s;
  std::vector<std::string> object;
  std::vector<std::uint8_t> dropped;
  for (const Clip& clip : clips) {
    start_s.push_back(clip.start_s), end_s.push_back(clip.end_s);
    object.push_back(clip.object), dropped.push_back(clip.object_fell ? 1 : 0);
  }
  return {"clips",
          {{"start_s", start_s}, {"end_s", end_s}, {"object", object}, {"dropped", dropped}},
          clips.size()};
}

std::vector<DataTable> tables_of(Labels labels) {
  DataTable main;
  main.rows = labels.time_s.size();
  main.arrays.push_back({"time_s", std::move(labels.time_s)});
  main.arrays.push_back({"clip", std::move(labels.clip)});
  main.arrays.push_back({"glove_frame", std::move(labels.glove_frame)});
  append_body(main, "object", labels.object);
  append_body(main, "hand", labels.hand);
  return {std::move(main), table_of_clips(labels.clips)};
}

std::vector<float> pressures(const GloveStream& glove) {
  std::vector<float> pressure(glove.counts.size());
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  for (std::size_t at = 0; at < pressure.size(); at += taxels)
    counts_to_pressure(glove.info, std::span(glove.counts).subspan(at, taxels),
                       std::span(pressure).subspan(at, taxels));
  return pressure;
}

DataTable table_of_glove(const std::string& name, const GloveStream& glove, double epoch_unix_s) {
  const std::vector<AxisNames> axes{numbered_axis(glove.info.rows), numbered_axis(glove.info.cols)};
  return {name,
          {{"time_s", glove.host_time_s},
           {"epoch_unix_s", std::vector<double>(glove.frames(), epoch_unix_s)},
           {"sequence", glove.sequence},
           {"counts", glove.counts, axes},
           {"pressure", pressures(glove), axes}},
          glove.frames()};
}

DataTable table_of_taxels(const std::string& name, const GloveInfo& info) {
  std::vector<std::int32_t> row, col;
  for (int i = 0; i < info.taxels(); ++i)
    row.push_back(i / info.cols), col.push_back(i % info.cols);
  return {name,
          {{"row", row},
           {"col", col},
           {"exists", info.mask},
           {"baseline_counts", info.baseline_counts},
           {"position_m", info.taxel_position_m, {xyz}}},
          row.size()};
}

std::vector<DataTable> tables_of(const Recording& recording, const std::string& file) {
  if (recording.gloves.empty())
    throw data_error(fmt::format("{} has no glove", file),
                     "tables of a recording hold its touch; for images choose mcap --images");
  std::vector<DataTable> tables;
  for (std::size_t i = 0; i < recording.gloves.size(); ++i)
    tables.push_back(table_of_glove(i == 0 ? "" : fmt::format("glove{}", i), recording.gloves[i],
                                    recording.epoch_unix_s));
  for (std::size_t i = 0; i < recording.gloves.size(); ++i)
    tables.push_back(table_of_taxels(i == 0 ? "taxels" : fmt::format("glove{}_taxels", i),
                                     recording.gloves[i].info));
  tables.push_back(table_of_clips(recording.clips));
  return tables;
}

std::vector<DataTable> tables_of(Predictions p) {
  DataTable main;
  main.rows = p.time_s.size();
  main.arrays = {{"time_s", std::move(p.time_s)},
                 {"clip", std::move(p.clip)},
                 {"step", std::move(p.step)},
                 {"start", std::move(p.start)}};
  for (auto& [name, values] : p.bodies) main.arrays.push_back({name, std::move(values), {xyz}});
  return {std::move(main)};
}

}  // namespace

std::size_t TableArray::row_values() const {
  std::size_t values_per_row = 1;
  for (const AxisNames& axis : axes) values_per_row *= axis.size();
  return values_per_row;
}

std::vector<DataTable> read_tables(const ExportRequest& request) {
  switch (request.kind) {
    case FileKind::labels:
      return tables_of(read_labels(request.input));
    case FileKind::recording:
      return tables_of(RecordingReader(request.input).recording(), request.input.string());
    case FileKind::predictions:
      return tables_of(read_predictions(request.input));
    case FileKind::model:
      break;
  }
  throw failure("a model has no tables", "report this as a bug");
}

}  // namespace touchtrace
