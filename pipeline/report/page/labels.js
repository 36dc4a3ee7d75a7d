// What the vision pipeline measured, what smoothing made of it, and how far that is from the truth.

function smoothingCharts(clip, body) {
  return [0, 1, 2].map((axis) => element("figure", {}, lineChart([
    { x: clip.raw_time_s, y: clip["raw_" + body].map((p) => p[axis]), stroke: "random", dots: 1.7 },
    { x: clip.time_s, y: clip[body].map((p) => p[axis]), stroke: body, width: 1.5 }],
    { width: 345, height: 170, title: `${body} ${axisNames[axis]}, m`, xLabel: "s" })));
}

function smoothingSection(recordings) {
  if (!recordings.length) return;
  section("smoothing", "Smoothing", "Positions as tracked in each camera frame (dots) and the smoothed labels (line); the first clip of each recording.",
    legend([{ name: "tracked", stroke: "random", dot: true }, { name: "object, smoothed", stroke: "object" }, { name: "hand, smoothed", stroke: "hand" }]),
    recordings.map((clip) => [element("h3", {}, clip.name), ["object", "hand"].map((body) => element("div", { class: "figures" }, smoothingCharts(clip, body)))]));
}

function labelErrorRow(recording, body, error) {
  const cells = (values, digits) => values.map((v) => number(fixed(v, digits)));
  return { group: body === "object", cells: [body === "object" ? recording : "", body, ...cells(error.bias_m.map((v) => v * 1000), 1), ...cells(error.position_spread_m.map((v) => v * 1000), 1),
    number(fixed(error.velocity_rms_m_per_s, 3)), number(fixed(100 * error.wrong_share, 2)), number(fixed(error.position_coverage, 2))] };
}

function labelErrorSection(metrics) {
  if (!metrics.label_errors.length) return;
  section("label-errors", "Labels against the truth",
    "Bias is the mean distance between what is tracked (the visible glove and object) and the truth (palm centre and centre of mass); RMS is what is left without it. " +
    "Wrong: further than 60 mm from there. Inside: share of positions within the label's own 80 % interval.",
    table(["recording", "body", ...["bias x, mm", "y", "z", "RMS x, mm", "y", "z", "velocity RMS, m/s", "wrong, %", "inside"].map(number)],
      metrics.label_errors.flatMap(({ recording, error }) => ["object", "hand"].map((body) => labelErrorRow(recording, body, error[body])))));
}
