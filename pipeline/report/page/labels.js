// Measured and smoothed positions, and errors of the labels.

function smoothingCharts(clip, body) {
  return [0, 1, 2].map((axis) => element("figure", {}, lineChart([
    { x: clip.raw_time_s, y: clip["raw_" + body].map((p) => p[axis]), stroke: "random", dots: 1.7 },
    { x: clip.time_s, y: clip[body].map((p) => p[axis]), stroke: body, width: 1.5 }],
    { width: 345, height: 170, title: `${body} ${axisNames[axis]}, m`, xLabel: "s" })));
}

const sourceStrokes = ["full", "without_touch", "without_embedding", "hand", "random"];

// Shares of the variance by source, stacked below the total standard deviation. Peaks, such as those of lost labels, are cut off.
function budgetChart(clip, body) {
  const labels = clip.time_s.map((time, i) => ({ time, variances: clip[body + "_budget"][i].map((s) => (known(s) ? 1e6 * s * s : null)) })).filter(({ variances }) => variances.every(known));
  const sum = (values) => values.reduce((total, v) => total + v, 0);
  const edge = (count) => labels.map(({ variances }) => sum(variances.slice(0, count)) / Math.sqrt(sum(variances) || 1));
  const total = edge(clip.error_sources.length).sort((a, b) => a - b);
  return element("figure", {}, lineChart(clip.error_sources.map((_, i) => ({ x: labels.map(({ time }) => time), y: edge(i + 1), band: [edge(i), edge(i + 1)], opacity: 0.45, width: 0.8, stroke: sourceStrokes[i % sourceStrokes.length] })),
    { width: 520, height: 190, title: `${body}, standard deviation, mm`, xLabel: "s", yRange: [0, 1.6 * (total[Math.floor(0.8 * total.length)] || 1)] }));
}

function errorBudget(clip) {
  if (!clip.error_sources.length || !clip.object_budget.length || !clip.hand_budget.length) return null;
  return [legend(clip.error_sources.map((name, i) => ({ name, stroke: sourceStrokes[i % sourceStrokes.length] }))), element("div", { class: "figures" }, ["object", "hand"].map((body) => budgetChart(clip, body)))];
}

function contactSheet(clip) {
  if (!clip.contact_sheet) return null;
  return element("figure", {}, element("img", { src: clip.contact_sheet, alt: "labels drawn into camera frames" }),
    element("figcaption", {}, "Camera frames with labels. Dot: measured. White cross and ellipse: smoothed, one standard deviation. Line: the last second. Evenly spread frames and the beginnings of the longest flagged stretches."));
}

function smoothingSection(recordings) {
  if (!recordings.length) return;
  section("smoothing", "Smoothing", "Positions measured in each camera frame (dots) and smoothed labels (line), camera frame; first clip of each recording. Bands: share of each source in the variance; their top is the standard deviation of the position, RMS over the axes.",
    legend([{ name: "measured", stroke: "random", dot: true }, { name: "object, smoothed", stroke: "object" }, { name: "hand, smoothed", stroke: "hand" }]),
    recordings.map((clip) => [element("h3", {}, clip.name), contactSheet(clip), errorBudget(clip), ["object", "hand"].map((body) => element("div", { class: "figures" }, smoothingCharts(clip, body)))]));
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
