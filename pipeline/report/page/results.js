// Tables of results, error per prediction step, and error over run time.

const resultColumns = [["l1_at_20", "L1@20", 3], ["l1_at_50", "L1@50", 3], ["hausdorff", "Hausdorff", 2],
  ["coverage_raw", "coverage, as predicted", 2], ["coverage", "coverage, rescaled", 2],
  ["object_error_m_at_50", "object error, m", 3], ["hand_error_m_at_50", "hand error, m", 3], ["rollouts", "roll-outs", 0]];
const lowerIsBetter = ["l1_at_20", "l1_at_50", "hausdorff", "object_error_m_at_50", "hand_error_m_at_50"];
const metricLabel = Object.fromEntries(resultColumns);

const groupOf = (row) => `${row.activity} · ${row.object}${row.split === "unseen" ? " (unseen)" : ""}`;

function groups(rows) {
  const found = new Map();
  for (const row of rows) found.set(groupOf(row), (found.get(groupOf(row)) || []).concat(row));
  return found;
}

function bestOf(rows, key) {
  const values = rows.map((row) => row[key]).filter(known);
  return lowerIsBetter.includes(key) && values.length ? Math.min(...values) : undefined;
}

function resultTable(results, rowOf) {
  const rows = [], columns = resultColumns.filter(([key]) => results.some((row) => known((rowOf(row) || {})[key])));
  for (const [name, all] of groups(results)) {
    const group = all.map((row) => ({ model: row.model, values: rowOf(row) })).filter(({ values }) => values);
    group.forEach(({ model, values }, i) => rows.push({
      group: i === 0,
      cells: [i === 0 ? name : "", modelLabel(model), ...columns.map(([key, , digits]) =>
        ({ text: fixed(values[key], digits), kind: values[key] === bestOf(group.map((g) => g.values), key) ? "best" : "number" }))],
    }));
  }
  return table(["", "model", ...columns.map(([, label]) => number(label))], rows);
}

const modelLegend = (rows) => legend(["random", "without_touch", "without_embedding", "full"].filter((model) => rows.some((row) => row.model === model))
  .map((model) => ({ name: modelLabel(model), stroke: model })));

// Full minus the other model: the error of Full is lower, higher, or not distinguishable.
const differenceVerdict = ({ low, high }) => (high < 0 ? "Full is better" : low > 0 ? "Full is worse" : "not significant");

function differenceTable(differences) {
  return table(["", "Full minus", "metric", number("mean"), number("95 % interval"), ""], differences.map((d) => ({
    cells: [groupOf(d), modelLabel(d.other), metricLabel[d.metric] || d.metric, number(fixed(d.mean, 3)), number(`${fixed(d.low, 3)} … ${fixed(d.high, 3)}`), differenceVerdict(d)],
  })));
}

// Nominal coverages of the bands, e.g. "0.80".
const nominalCoverages = (metrics) => [...new Set(metrics.curves.map((curve) => curve.nominal_coverage).filter(known))].map((level) => fixed(level, 2)).join(" or ");

function resultSection(metrics) {
  const truth = metrics.against === "truth";
  section("results", "Results",
    `Roll-outs of 50 steps on clips that were not used for training or tuning, compared with ${truth ? "the true states of the simulation" : "the labels from video"}. ` +
    "L1@20, L1@50: mean absolute error of the first 20 or 50 steps. Hausdorff: distance between the predicted and the actual path. Both in units of the standard deviation of the training labels, per state dimension. " +
    `Coverage: fraction of states inside the predicted band, as predicted and after rescaling the band on validation clips${nominalCoverages(metrics) ? `; ideal ${nominalCoverages(metrics)}` : ""}. Errors in metres: mean distance over the 50 steps. ` +
    "Random is an actual path from another time; its Hausdorff distance can be lower than that of w/o Touch, which stays near the mean.",
    truth ? element("p", { class: "note" }, "Simulated recordings: these results do not show how well the model works with a real glove.") : null,
    resultTable(metrics.results, (row) => row),
    metrics.differences.length ? [element("p", {}, "Difference of errors; negative: Full is better. Intervals: bootstrap over clips."), differenceTable(metrics.differences)] : null,
    truth ? element("details", {}, element("summary", {}, "Results compared with the labels from video"), resultTable(metrics.results, (row) => row.against_labels)) : null);
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
        { title: `band coverage, ${name}`, xLabel: "steps ahead", yRange: [0, 1], levels: [...new Set(banded.map((curve) => curve.nominal_coverage ?? 0.8))] })));
  }
  return charts;
}

function horizonSection(metrics) {
  if (!metrics.curves.length) return;
  section("horizon", "Error per prediction step", "Mean error at each step, and fraction of states inside the band: as predicted (dashed) and after rescaling on validation clips (solid). Dotted: nominal coverage.",
    modelLegend(metrics.curves),
    element("div", { class: "figures" }, horizonCharts(metrics)));
}

function trainingChart(activity, models) {
  return lineChart(models.filter((model) => model.log.length).map((model) => ({ x: model.log.map((e) => e.seconds), y: model.log.map((e) => e.validation_l1_at_20), stroke: model.model })),
    { title: `validation L1@20, ${activity}`, xLabel: "training time, s" });
}

function runTimeSection(data) {
  const models = data.metrics ? data.metrics.models : [];
  const activities = [...new Set(models.map((model) => model.activity))];
  if (!data.stages.length && !models.length) return;
  section("run-time", "Error over run time", "Error on validation clips during training, and the run time of each stage.",
    models.length ? modelLegend(models) : null,
    element("div", { class: "figures" }, activities.map((activity) => element("figure", {}, trainingChart(activity, models.filter((m) => m.activity === activity))))),
    table(["command", "file", number("seconds"), number("CPU seconds"), "device"],
      data.stages.map((s) => ({ cells: [s.verb, s.artefact, number(fixed(s.wall_seconds, 1)), number(fixed(s.cpu_seconds, 1)), s.device || "–"] }))));
}
