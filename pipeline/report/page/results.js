// Tables of results, error per prediction step, and error over run time.

const resultColumns = [["l1_at_20", "L1@20", 3], ["l1_at_50", "L1@50", 3], ["hausdorff", "Hausdorff", 2],
  ["coverage_raw", "coverage, as predicted", 2], ["coverage", "coverage, rescaled", 2],
  ["object_error_m_at_50", "object, m", 3], ["object_error_m_per_s_at_50", "object, m/s", 3],
  ["hand_error_m_at_50", "hand, m", 3], ["hand_error_m_per_s_at_50", "hand, m/s", 3],
  ["object_hausdorff_m", "object Hausdorff, m", 3], ["runs", "seeds", 0], ["clips", "clips", 0], ["rollouts", "roll-outs", 0]];
const lowerIsBetter = resultColumns.map(([key]) => key).filter((key) => /l1|hausdorff|error/.test(key));

const groupOf = (row) => `${row.activity} · ${row.object}${row.split === "unseen" ? " (unseen)" : ""}${row.data_set ? ` · ${row.data_set}` : ""}`;

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

// Colour of a model: its kind's, or for further groups of a kind another one.
const spareStrokes = ["hand", "accent", "without_embedding", "soft"];

function strokes(rows) {
  const found = new Map(), kinds = new Set();
  for (const { model, kind } of rows) {
    if (found.has(model)) continue;
    found.set(model, kinds.has(kind) ? spareStrokes[found.size % spareStrokes.length] : kind);
    kinds.add(kind);
  }
  return found;
}

const modelLegend = (rows) => legend([...strokes(rows)].map(([model, stroke]) => ({ name: modelLabel(model), stroke })));

const differenceColumns = resultColumns.filter(([key]) => lowerIsBetter.includes(key) && key !== "l1_at_20");

// Mean and interval; bold where the interval excludes 0.
function differenceCell({ mean, low, high } = {}, digits) {
  if (!known(mean)) return number("–");
  const text = known(low) ? `${fixed(mean, digits)} (${fixed(low, digits)} … ${fixed(high, digits)})` : fixed(mean, digits);
  return { text, kind: known(low) && (high < 0 || low > 0) ? "best" : "number" };
}

function differenceTable(differences) {
  return table(["", "model", "minus", ...differenceColumns.map(([, label]) => number(label))], differences.map((d) => ({
    cells: [groupOf(d), modelLabel(d.model), modelLabel(d.other), ...differenceColumns.map(([key, , digits]) => differenceCell(d.metrics[key], digits))],
  })));
}

function runTable(runs) {
  const columns = resultColumns.filter(([key]) => runs.some((run) => known(run[key])));
  return table(["", "model", number("seed"), "file", ...columns.map(([, label]) => number(label))], runs.map((run) => ({
    cells: [groupOf(run), modelLabel(run.model), number(String(run.seed)), run.file, ...columns.map(([key, , digits]) => number(fixed(run[key], digits)))] })));
}

// Nominal coverages of the bands, e.g. "0.80".
const nominalCoverages = (metrics) => [...new Set(metrics.curves.map((curve) => curve.nominal_coverage).filter(known))].map((level) => fixed(level, 2)).join(" or ");

function resultSection(metrics) {
  const truth = metrics.against === "truth";
  const alternative = (title, key) => element("details", {}, element("summary", {}, title), resultTable(metrics.results, (row) => row[key]));
  section("results", "Results",
    `Roll-outs of 50 steps on clips that were not used for training or tuning, compared with ${truth ? "the true states of the simulation, shifted by the mean offset of the labels" : "the labels from video"}. ` +
    "L1@20, L1@50: mean absolute error of the first 20 or 50 steps. Hausdorff: distance between the predicted and the actual path. Both in units of the standard deviation of the training labels, per state dimension. " +
    `Coverage: fraction of states inside the predicted band, as predicted and after rescaling the band on calibration clips${nominalCoverages(metrics) ? `; ideal ${nominalCoverages(metrics)}` : ""}. m, m/s: mean error of position and velocity over the 50 steps. ` +
    "Random is an actual path from another time; its Hausdorff distance can be lower than that of w/o Touch, which stays near the mean. Hold: initial position, velocity 0. Damped: the initial velocity decays. Median: of the training states. Linear: regression on the initial state.",
    truth ? element("p", { class: "note" }, "Simulated recordings: these results do not show how well the model works with a real glove.") : null,
    metrics.notes.map((note) => element("p", { class: "note" }, note)),
    resultTable(metrics.results, (row) => row),
    metrics.differences.length ? [element("p", {}, "Difference of errors; negative: the first model is better. 95 % intervals: bootstrap over clips and seeds. Bold: the interval excludes 0."), differenceTable(metrics.differences)] : null,
    metrics.runs.length ? element("details", {}, element("summary", {}, "Results of each model file"), runTable(metrics.runs)) : null,
    truth ? [alternative("Results compared with the labels from video", "against_labels"), alternative("Results compared with the true states without the shift", "against_unshifted_truth")] : null);
}

const chartedKinds = ["random", "hold", "without_touch", "without_embedding", "full"];

function horizonCharts(all) {
  const charts = [], stroke = strokes(all);
  for (const [name, curves] of groups(all)) {
    const steps = curves[0].l1_by_step.map((_, i) => i + 1);
    const line = (curve, y, dash) => ({ x: steps, y, stroke: stroke.get(curve.model), dash });
    const banded = curves.filter((curve) => curve.coverage_raw_by_step);
    charts.push(element("figure", {},
      lineChart(curves.map((curve) => line(curve, curve.l1_by_step)), { title: `L1, ${name}`, xLabel: "steps ahead", yRange: [0, extent(curves.flatMap((c) => c.l1_by_step))[1] * 1.1] }),
      lineChart(banded.flatMap((curve) => [...(curve.coverage_by_step ? [line(curve, curve.coverage_by_step)] : []), line(curve, curve.coverage_raw_by_step, "4 3")]),
        { title: `band coverage, ${name}`, xLabel: "steps ahead", yRange: [0, 1], levels: [...new Set(banded.map((curve) => curve.nominal_coverage ?? 0.8))] })));
  }
  return charts;
}

function horizonSection(metrics) {
  const curves = metrics.curves.filter((curve) => chartedKinds.includes(curve.kind));
  if (!curves.length) return;
  section("horizon", "Error per prediction step", "Mean error at each step, and fraction of states inside the band: as predicted (dashed) and after rescaling on calibration clips (solid). Dotted: nominal coverage.",
    modelLegend(curves),
    element("div", { class: "figures" }, horizonCharts(curves)));
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
    models.length ? modelLegend(models.map(({ model }) => ({ model, kind: model }))) : null,
    element("div", { class: "figures" }, activities.map((activity) => element("figure", {}, trainingChart(activity, models.filter((m) => m.activity === activity))))),
    table(["command", "file", number("seconds"), number("CPU seconds"), "device"],
      data.stages.map((s) => ({ cells: [s.command, s.artefact, number(fixed(s.wall_seconds, 1)), number(fixed(s.cpu_seconds, 1)), s.device || "–"] }))));
}
