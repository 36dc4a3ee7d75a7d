// Error over a training option of which models have several values, such as the resolution.

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

function optionSection(metrics) {
  const charts = [...groups(metrics.results)].flatMap(([name, rows]) => variedOptions(rows).map((key) => optionChart(name, rows, key)));
  if (!charts.length) return;
  section("options", "Error over options", "Mean error over 50 steps of models that differ in an option; bands: 95 % intervals over clips and seeds.",
    element("div", { class: "figures" }, charts));
}
