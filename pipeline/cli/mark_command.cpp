#include <fmt/core.h>

#include <map>

#include "engine/base/progress.h"
#include "pipeline/cli/commands.h"
#include "pipeline/mark/mark_server.h"

namespace touchtrace::cli {
namespace {

struct MarkOptions {
  std::string recording, output;
  std::vector<std::string> boxes;
  int clip = 0, frame = -1, port = 0;
};

void describe(OptionSet& set, MarkOptions& o) {
  set.input("recording", o.recording, "HDF5 with colour images");
  set.text("output", o.output, "recording with the boxes; default: RECORDING is replaced")
      .value("FILE");
  set.texts("box", o.boxes, "hand=X,Y,WIDTH,HEIGHT and object=... [px]; default: draw on a page")
      .value("BOX");
  set.integer("clip", o.clip, "clip of --box, counted from 0", 0, 1'000'000);
  set.integer(
      "frame", o.frame,
      "camera frame of --box, counted from 0 at the recording's start; -1: the clip's first", -1,
      100'000'000);
  set.integer("port", o.port, "of the page on 127.0.0.1; 0: any free one", 0, 65535);
}

/// Boxes by "hand" and "object".
std::map<std::string, PixelBox> parse_boxes(const std::vector<std::string>& texts) {
  std::map<std::string, PixelBox> boxes;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    const std::string name = text.substr(0, equals);
    if (equals == std::string::npos || (name != "hand" && name != "object"))
      throw usage_error(fmt::format("--box '{}' is not of hand or object", text),
                        "write --box hand=X,Y,WIDTH,HEIGHT --box object=X,Y,WIDTH,HEIGHT");
    boxes[name] = parse_box(text.substr(equals + 1));
  }
  if (boxes.size() != 2 || texts.size() != 2)
    throw usage_error("--box is needed once for hand and once for object",
                      "write --box hand=X,Y,WIDTH,HEIGHT --box object=X,Y,WIDTH,HEIGHT");
  return boxes;
}

void save_boxes(MarkSession& session, const MarkOptions& options) {
  auto boxes = parse_boxes(options.boxes);
  ClipBoxes drawn{static_cast<std::size_t>(options.clip), 0, boxes["hand"], boxes["object"]};
  const auto& clips = session.recording().clips;
  if (options.frame >= 0)
    drawn.frame = static_cast<std::size_t>(options.frame);
  else if (drawn.clip < clips.size())
    drawn.frame = session.frames_of(clips[drawn.clip]).first;
  session.save({drawn});
  // camera frames without depth are not counted, so that the number may be another than a file's
  Progress::report(fmt::format("boxes are those of camera frame {}, at {:.3f} s", drawn.frame,
                               session.recording().camera_times.host_time_s[drawn.frame]));
}

ExitCode run(const MarkOptions& options, const Invocation& invocation) {
  const std::string& output = options.output.empty() ? options.recording : options.output;
  MarkSession session(options.recording, output, invocation.overwrite);
  if (options.boxes.empty())
    serve_mark_page(session, options.port);
  else
    save_boxes(session, options);
  nlohmann::json state = session.state();
  std::size_t marked = 0;
  for (const auto& clip : state["clips"])
    marked += !clip["hand"].is_null() && !clip["object"].is_null();
  if (invocation.json)
    fmt::print("{}\n", state.dump(2));
  else
    fmt::print("{}: {} of {} clips have boxes\n", output, marked, state["clips"].size());
  return ExitCode::done;
}

}  // namespace

Command mark_command() {
  return make_command<MarkOptions>(
      "mark", "draw boxes around hand and object, for `label`",
      {"touchtrace mark my.h5",
       "touchtrace mark my.h5 --box hand=120,80,60,50 --box object=150,70,30,30 --frame 12"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
