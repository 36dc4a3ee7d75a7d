// Error over a training option of which models have several values, such as the resolution, and over the time of training.

const valueOf = (row, key) => (row.options || {})[key];

// Options with three or more numbers.
function variedOptions(rows) {
  const keys = new Set(rows.flatMap((row) => Object.keys(row.options || {})));
  return [...keys].filter((key) => new Set(rows.map((row) => valueOf(row, key)).filter(known)).size >= 3);
}

function optionLine(kind, rows, key) {
  const sorted = rows.filter((row) => row.kind === kind).sort((a, b) => valueOf(a, key) - valueOf(b, key));
  const bounds = [0, 1].map((i) => sorted.map((row) => ((row.intervals || {}).l1_at_50 || [])[i]));
  return { x: sorted.map((row) => valueOf(row, key)), y: sorted.map((row) => row.l1_at_50), stroke: kind,
    band: bounds.flat().every(known) ? bounds : undefined };
}

function optionChart(name, rows, key) {
  const varied = rows.filter((row) => known(valueOf(row, key))), range = extent(varied.map((row) => valueOf(row, key)));
  const others = rows.filter((row) => !known(valueOf(row, key)) && ["hold", "without_touch"].includes(row.kind));
  const constants = others.map((row) => ({ x: range, y: [row.l1_at_50, row.l1_at_50], stroke: row.kind, dash: "4 3" }));
  const lines = [...new Set(varied.map((row) => row.kind))].map((kind) => optionLine(kind, varied, key));
  return element("figure", {}, lineChart([...lines, ...constants], { title: `L1@50, ${name}`, xLabel: key.replaceAll("_", " ") }),
    legend([...lines, ...constants].map(({ stroke, dash }) => ({ name: modelLabel(stroke), stroke, dash }))));
}

// Mean CPU seconds of the trainings of a row.
function trainingSeconds(row, runs) {
  const seconds = runs.filter((run) => run.model === row.model).map((run) => run.training_cpu_seconds);
  return seconds.length && seconds.every(known) ? seconds.reduce((a, b) => a + b) / seconds.length : null;
}

// Points of which none other has both less time and a smaller error.
function front(points) {
  const sorted = [...points].sort((a, b) => a.seconds - b.seconds || a.error - b.error);
  return sorted.filter((point, i) => sorted.slice(0, i).every((other) => other.error > point.error));
}

function costChart(name, rows, runs) {
  const points = rows.map((row) => ({ kind: row.kind, label: row.model.replace(row.kind, "").trim(), seconds: trainingSeconds(row, runs), error: row.l1_at_50 }))
    .filter(({ seconds, error }) => known(seconds) && known(error));
  if (points.length < 3) return [];
  const kinds = [...new Set(points.map(({ kind }) => kind))], xs = (list) => list.map((p) => p.seconds), ys = (list) => list.map((p) => p.error);
  const dots = kinds.map((kind) => points.filter((p) => p.kind === kind)).map((list) => ({ x: xs(list), y: ys(list), stroke: list[0].kind, dots: 3.5, labels: list.map((p) => p.label) }));
  const best = front(points), range = extent(xs(points));
  return element("figure", {}, lineChart([{ x: xs(best), y: ys(best), stroke: "soft", dash: "4 3" }, ...dots],
    { title: `L1@50 over training time, ${name}`, xLabel: "CPU seconds", width: 700, height: 380, xRange: [range[0], range[1] + 0.25 * (range[1] - range[0])] }),
  legend(kinds.map((kind) => ({ name: modelLabel(kind), stroke: kind, dot: true }))));
}

function optionSection(metrics) {
  const runsOf = groups(metrics.runs);
  const charts = [...groups(metrics.results)].flatMap(([name, rows]) =>
    [...variedOptions(rows).map((key) => optionChart(name, rows, key)), costChart(name, rows, runsOf.get(name) || [])].flat());
  if (!charts.length) return;
  section("options", "Error over options", "Mean error over 50 steps of models that differ in an option; bands: 95 % intervals over clips and seeds. Over training time: the dashed line joins the models that no other beats in both.",
    element("div", { class: "figures" }, charts));
}
