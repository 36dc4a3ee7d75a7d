// The table of results, curves over the horizon, and error against run time.

const resultColumns = [["l1_at_20", "L1@20", 3], ["l1_at_50", "L1@50", 3], ["hausdorff", "Hausdorff", 2],
  ["coverage", "coverage of the band", 2], ["object_error_m_at_50", "object error, m", 3], ["hand_error_m_at_50", "hand error, m", 3]];

const groupOf = (row) => `${row.activity} · ${row.object}${row.split === "unseen" ? " (unseen)" : ""}`;

function groups(rows) {
  const found = new Map();
  for (const row of rows) found.set(groupOf(row), (found.get(groupOf(row)) || []).concat(row));
  return found;
}

function bestOf(rows, key) {
  const values = rows.map((row) => row[key]).filter(known);
  return key === "coverage" || !values.length ? undefined : Math.min(...values);
}

function resultTable(results, rowOf) {
  const rows = [];
  for (const [name, all] of groups(results)) {
    const group = all.map((row) => ({ model: row.model, values: rowOf(row) })).filter(({ values }) => values);
    group.forEach(({ model, values }, i) => rows.push({
      group: i === 0,
      cells: [i === 0 ? name : "", modelLabel(model), ...resultColumns.map(([key, , digits]) =>
        ({ text: fixed(values[key], digits), kind: values[key] === bestOf(group.map((g) => g.values), key) ? "best" : "number" }))],
    }));
  }
  return table(["", "model", ...resultColumns.map(([, label]) => number(label))], rows);
}

const modelLegend = (rows) => legend(["random", "without_touch", "without_embedding", "full"].filter((model) => rows.some((row) => row.model === model))
  .map((model) => ({ name: modelLabel(model), stroke: model })));

function differenceTable(differences) {
  return table(["", "Full minus", "", number("mean"), number("95 % interval")], differences.map((d, i) => ({
    cells: [groupOf(d), modelLabel(d.other), ({ l1_at_20: "L1@20", l1_at_50: "L1@50", hausdorff: "Hausdorff" })[d.metric], number(fixed(d.mean, 3)), number(`${fixed(d.low, 3)} … ${fixed(d.high, 3)}`)],
  })));
}

function resultSection(metrics) {
  const truth = metrics.against === "truth";
  section("results", "Results",
    `Roll-outs of 50 steps on clips that no model was trained or tuned on, held against ${truth ? "what really happened in the simulation" : "the labels of the vision pipeline"}. ` +
    "L1 and Hausdorff are in units of the training labels' deviation per state dimension; errors in metres are the mean distance over the 50 steps.",
    resultTable(metrics.results, (row) => row),
    metrics.differences.length ? [element("p", {}, "Negative means that what Full has helps. The interval is a bootstrap over whole clips."), differenceTable(metrics.differences)] : null,
    truth ? element("details", {}, element("summary", {}, "The same against the labels"), resultTable(metrics.results, (row) => row.against_labels)) : null);
}

function horizonCharts(metrics) {
  const charts = [];
  for (const [name, curves] of groups(metrics.curves)) {
    const steps = curves[0].l1_by_step.map((_, i) => i + 1);
    const line = (curve, y, dash) => ({ x: steps, y, stroke: curve.model, dash });
    const banded = curves.filter((curve) => curve.coverage_by_step);
    charts.push(element("figure", {},
      lineChart(curves.map((curve) => line(curve, curve.l1_by_step)), { title: `L1, ${name}`, xLabel: "steps ahead", yRange: [0, extent(curves.flatMap((c) => c.l1_by_step))[1] * 1.1] }),
      lineChart(banded.flatMap((curve) => [line(curve, curve.coverage_by_step), line(curve, curve.coverage_raw_by_step, "4 3")]),
        { title: `coverage of the band, ${name}`, xLabel: "steps ahead", yRange: [0, 1], levels: [...new Set(banded.map((curve) => curve.nominal_coverage ?? 0.8))] })));
  }
  return charts;
}

function horizonSection(metrics) {
  if (!metrics.curves.length) return;
  section("horizon", "Against the horizon", "Mean error of each step, and the share of states inside the band: as predicted (dashed) and after scaling on validation clips (solid). The dotted level is what the band's quantiles promise.",
    modelLegend(metrics.curves),
    element("div", { class: "figures" }, horizonCharts(metrics)));
}

function trainingChart(activity, models) {
  return lineChart(models.filter((model) => model.log.length).map((model) => ({ x: model.log.map((e) => e.seconds), y: model.log.map((e) => e.validation_l1_at_20), stroke: model.model })),
    { title: `validation L1@20, ${activity}`, xLabel: "seconds of training" });
}

function runTimeSection(data) {
  const models = data.metrics ? data.metrics.models : [];
  const activities = [...new Set(models.map((model) => model.activity))];
  if (!data.stages.length && !models.length) return;
  section("run-time", "Error against run time", "Error on validation clips while training, and the seconds that each stage took.",
    models.length ? modelLegend(models) : null,
    element("div", { class: "figures" }, activities.map((activity) => element("figure", {}, trainingChart(activity, models.filter((m) => m.activity === activity))))),
    table(["stage", "artefact", number("seconds"), number("processor seconds"), "device"],
      data.stages.map((s) => ({ cells: [s.verb, s.artefact, number(fixed(s.wall_seconds, 1)), number(fixed(s.cpu_seconds, 1)), s.device || "–"] }))));
}
