// Measured and smoothed positions, and errors of the labels.

function smoothingCharts(clip, body) {
  return [0, 1, 2].map((axis) => element("figure", {}, lineChart([
    { x: clip.raw_time_s, y: clip["raw_" + body].map((p) => p[axis]), stroke: "random", dots: 1.7 },
    { x: clip.time_s, y: clip[body].map((p) => p[axis]), stroke: body, width: 1.5 }],
    { width: 345, height: 170, title: `${body} ${axisNames[axis]}, m`, xLabel: "s" })));
}

function smoothingSection(recordings) {
  if (!recordings.length) return;
  section("smoothing", "Smoothing", "Positions measured in each camera frame (dots) and smoothed labels (line), camera frame; first clip of each recording.",
    legend([{ name: "measured", stroke: "random", dot: true }, { name: "object, smoothed", stroke: "object" }, { name: "hand, smoothed", stroke: "hand" }]),
    recordings.map((clip) => [element("h3", {}, clip.name), ["object", "hand"].map((body) => element("div", { class: "figures" }, smoothingCharts(clip, body)))]));
}

function labelErrorRow(recording, body, error) {
  const cells = (values, digits) => values.map((v) => number(fixed(v, digits)));
  return { group: body === "object", cells: [body === "object" ? recording : "", body, ...cells(error.bias_m.map((v) => v * 1000), 1), ...cells(error.position_spread_m.map((v) => v * 1000), 1),
    number(fixed(error.velocity_rms_m_per_s, 3)), number(fixed(100 * error.lost_share, 2)), number(fixed(100 * error.wrong_share, 2)), number(body === "object" ? fixed(error.position_coverage, 2) : "–")] };
}

function labelErrorSection(metrics) {
  if (!metrics.label_errors.length) return;
  section("label-errors", "Label errors",
    "Labels compared with the true states of the simulation. Bias: mean offset between the tracked surface (glove, object) and the true point (palm centre, centre of mass). RMS: error after removing bias and delay. " +
    "Lost: labels marked as lost. Wrong: not marked, but more than 60 mm off. Coverage: fraction of positions within the label's 80 % interval; ideal 0.80; not meaningful for the hand because of its bias.",
    table(["recording", "body", ...["bias x, mm", "y", "z", "RMS x, mm", "y", "z", "velocity RMS, m/s", "lost, %", "wrong, %", "coverage"].map(number)],
      metrics.label_errors.flatMap(({ recording, error }) => ["object", "hand"].map((body) => labelErrorRow(recording, body, error[body])))));
}
