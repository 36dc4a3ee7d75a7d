// Example roll-outs: paths in 3-D, each axis with its band, and the tactile frames.

const axisNames = ["x", "y (down)", "z (away)"];
const bodies = [{ name: "object", first: 0 }, { name: "hand", first: 6 }];

function examplePaths(example, body) {
  const points = (states) => states.map((state) => state.slice(body.first, body.first + 3));
  const radius = (spread) => spread.map((row) => Math.hypot(...row.slice(body.first, body.first + 3)) / Math.sqrt(3));
  const paths = Object.entries(example.models).map(([model, rollout]) => ({
    points: points(rollout.state), stroke: model, dash: model === "full" ? [] : [5, 4], radii: model === "full" ? radius(rollout.spread) : null }));
  return [{ points: points(example.target), stroke: "truth" }, ...paths];
}

function axisChart(example, body, axis) {
  const d = body.first + axis, time = example.target.map((_, i) => (i + 1) / example.rate_hz);
  const column = (rows) => rows.map((row) => row[d]);
  const series = Object.entries(example.models).map(([model, { state, spread }]) => ({
    x: time, y: column(state), stroke: model, dash: model === "full" ? null : "5 4",
    band: model === "full" ? [-1, 1].map((sign) => state.map((row, i) => row[d] + sign * spread[i][d])) : null }));
  return lineChart([...series, { x: time, y: column(example.target), stroke: "truth", width: 1.5 }],
    { width: 345, height: 170, title: `${body.name} ${axisNames[axis]}, m`, xLabel: "s" });
}

function exampleView(example) {
  const charts = bodies.map((body) => [0, 1, 2].map((axis) => axisChart(example, body, axis)));
  const moveCursors = (step) => charts.flat().forEach((chart) => chart.moveCursor(step / example.rate_hz));
  const view = (body) => element("figure", {}, pathView(examplePaths(example, body), 390, 320), element("figcaption", {}, `${body.name}; drag to rotate`));
  return element("div", {}, element("div", { class: "figures" }, bodies.map(view),
    example.tactile ? tactileView(example.tactile, example.rate_hz, moveCursors) : null),
    charts.map((row) => element("div", { class: "figures" }, row.map((chart) => element("figure", {}, chart)))));
}

function exampleChooser(activity, examples) {
  const container = element("div");
  const choice = element("select", { "aria-label": `example of ${activity}` }, examples.map((e, i) =>
    element("option", { value: i }, `${e.object}, ${e.rank} roll-out: L1@50 ${fixed(e.l1_at_50, 3)} (${e.recording}, clip ${e.clip}, from ${fixed(e.start_s, 1)} s)`)));
  const show = () => container.replaceChildren(exampleView(examples[Number(choice.value)]));
  choice.addEventListener("change", show);
  show();
  return [element("h3", {}, activity), element("div", { class: "control" }, choice), container];
}

function exampleSection(metrics) {
  const activities = [...new Set(metrics.examples.map((example) => example.activity))];
  if (!activities.length) return;
  section("roll-outs", metrics.against === "truth" ? "Predicted and true paths" : "Predicted and labelled paths", "Evaluation roll-outs with the median, smallest and largest L1@50 of the Full model. Band: between the two predicted quantiles, rescaled. Coordinates: camera frame.",
    legend([{ name: metrics.against === "truth" ? "truth" : "labels", stroke: "truth" }, { name: "Full, with band", stroke: "full" }, { name: "w/o Touch", stroke: "without_touch", dash: true }]),
    activities.map((activity) => exampleChooser(activity, metrics.examples.filter((e) => e.activity === activity))));
}
