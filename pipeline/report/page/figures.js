// Measurements with goals, from `touchtrace-verify --json` and `scripts/bench --json`.

const curveStrokes = ["full", "without_touch", "hand", "truth", "random"];

function figurePicture({ name, picture }) {
  const curves = picture.curves.map((curve, i) => ({ ...curve, stroke: curveStrokes[i % curveStrokes.length] }));
  const scaled = (values, logarithmic) => (logarithmic ? values.map((v) => (v > 0 ? Math.log10(v) : null)) : values);
  const label = (text, logarithmic) => (logarithmic ? `log10 of ${text}` : text);
  return element("figure", {},
    lineChart(curves.map((c) => ({ x: scaled(c.x, picture.log_x), y: scaled(c.y, picture.log_y), stroke: c.stroke })),
      { xLabel: label(picture.x_label, picture.log_x), yLabel: label(picture.y_label, picture.log_y) }),
    legend(curves), element("figcaption", {}, name));
}

function figuresSection(files) {
  if (!files.length) return;
  section("figures", "Figures", "Measured quantities and their goals, from touchtrace-verify and scripts/bench on the machine that wrote these files.",
    files.map(({ name, figures }) => [element("h3", {}, name),
      element("div", { class: "figures" }, figures.filter((figure) => figure.picture).map(figurePicture)),
      table(["figure", number("value"), "unit", "goal", "", number("seconds")], figures.map((f) => ({
        cells: [f.name, number(known(f.value) ? f.value.toPrecision(4) : "–"), f.unit, f.goal, f.holds ? "PASS" : "FAIL",
          number(known(f.seconds) ? f.seconds.toFixed(2) : "–")] })))]));
}
