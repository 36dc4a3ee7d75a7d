// Builds the page from the data beside it. What was not given has no section.

const residualScale = 100;

// Residual vectors where the corners lie, magnified.
function residualField(calibration) {
  const { corners, width, height } = calibration, lines = { x: [], y: [] };
  for (const [u, v, du, dv] of corners) {
    lines.x.push(u, u + residualScale * du, null);
    lines.y.push(v, v + residualScale * dv, null);
  }
  return lineChart([{ ...lines, stroke: "full", width: 1 }, { x: corners.map((c) => c[0]), y: corners.map((c) => c[1]), stroke: "soft", dots: 1 }],
    { width: 480, height: 370, title: `residuals in the image, ${residualScale} times longer`, xLabel: "x, px", xRange: [0, width], yRange: [height, 0] });
}

function calibrationView(calibration) {
  const { name, corners, views, sigmas } = calibration;
  const depth = calibration.depth_rms_m > 0 ? `, of depth ${fixed(1000 * calibration.depth_rms_m, 2)} mm` : "";
  return [element("h3", {}, name),
    element("p", {}, `RMS of the corners ${fixed(calibration.rms_px, 3)} px${depth}. Verdict: ${calibration.verdict}. ${calibration.advice.join(" ")}`),
    element("div", { class: "figures" }, element("figure", {}, residualField(calibration)),
      element("figure", {}, lineChart([{ x: corners.map((c) => c[2]), y: corners.map((c) => c[3]), stroke: "full", dots: 1.4 }],
        { width: 330, height: 370, title: "corner residuals, px", xLabel: "x, px" })),
      element("figure", {}, lineChart([{ x: views.map((_, i) => i + 1), y: views.map((v) => v.rms_px), stroke: "full", dots: 3 }],
        { width: 270, height: 370, title: "RMS of each view, px", xLabel: "view", yRange: [0, extent(views.map((v) => v.rms_px))[1] * 1.2], xRange: [0, views.length + 1] }))),
    element("details", {}, element("summary", {}, "Deviations of the parameters"),
      table(["parameter", number("deviation")], Object.entries(sigmas).map(([parameter, sigma]) => ({ cells: [parameter, number(known(sigma) ? sigma.toPrecision(3) : "–")] }))))];
}

function calibrationSection(calibrations) {
  if (!calibrations.length) return;
  section("calibration", "Calibration", "What is left of the chessboards' corners after the joint fit.", calibrations.map(calibrationView));
}

function provenanceSection(artefacts) {
  if (!artefacts.length) return;
  section("provenance", "Provenance", "What made each artefact: options, seed, hashes of its inputs, device, version.",
    artefacts.map(({ artefact, provenance }) => element("details", {},
      element("summary", {}, `${artefact} — ${provenance.verb || ""}, ${provenance.created || ""}`),
      element("pre", {}, JSON.stringify(provenance, null, 2)))));
}

// One part that cannot be drawn must not take the others with it.
function draw(part, ...data) {
  try {
    part(...data);
  } catch (error) {
    document.getElementById("main").append(element("p", {}, `A part of this report could not be drawn: ${error.message}`));
  }
}

function build() {
  const data = JSON.parse(document.getElementById("data").textContent), metrics = data.metrics;
  document.getElementById("subtitle").textContent = [data.title, `touchtrace ${data.version}`, data.created, metrics && metrics.device].filter(Boolean).join(" · ");
  if (metrics) for (const part of [resultSection, exampleSection, horizonSection]) draw(part, metrics);
  draw(runTimeSection, data);
  if (metrics) draw(labelErrorSection, metrics);
  draw(smoothingSection, data.smoothing);
  draw(calibrationSection, data.calibrations);
  draw(figuresSection, data.figures);
  draw(provenanceSection, data.artefacts);
}

build();
