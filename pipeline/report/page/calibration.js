// What is left of a calibration's corners, and how well it knows each pixel.

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

// What a far point's pixel may be off by, at the pixels of a grid that reaches to the image's edges.
function uncertaintyMap({ projection_sigma_px: rows, width, height }) {
  const box = { left: 8, top: 24, width: 480, height: (480 * height) / width };
  const highest = extent(rows.flat())[1], [across, down] = [box.width / rows[0].length, box.height / rows.length];
  const svg = svgElement("svg", { viewBox: `0 0 ${box.width + 16} ${box.height + 32}`, width: box.width + 16, height: box.height + 32, role: "img", style: "max-width:100%;height:auto" });
  svg.append(svgElement("text", { class: "title", x: box.left, y: box.top - 8 }, "how well each pixel is known, px"));
  rows.forEach((row, j) => row.forEach((sigma, i) => {
    const [x, y, level] = [box.left + i * across, box.top + j * down, known(sigma) ? sigma / highest : 0];
    svg.append(svgElement("rect", { x, y, width: across, height: down, fill: `rgb(${heat(level).map(Math.round).join(" ")})` }),
      svgElement("text", { x: x + across / 2, y: y + down / 2 + 4, "text-anchor": "middle", style: `fill:${level > 0.6 ? "#000" : "#fff"}` }, fixed(sigma, 2)));
  }));
  return svg;
}

function calibrationView(calibration) {
  const { name, corners, views, sigmas } = calibration;
  const depth = calibration.depth_rms_m > 0 ? `, of depth ${fixed(1000 * calibration.depth_rms_m, 2)} mm` : "";
  const print = calibration.print_sigma_m > 0 ? ` The board's corners are off by ${fixed(1000 * calibration.print_sigma_m, 3)} mm: calibrated with the camera.` : "";
  return [element("h3", {}, name),
    element("p", {}, `RMS of the corners ${fixed(calibration.rms_px, 3)} px${depth}.${print} Verdict: ${calibration.verdict}. ${calibration.advice.join(" ")}`),
    element("div", { class: "figures" }, element("figure", {}, residualField(calibration)),
      element("figure", {}, lineChart([{ x: corners.map((c) => c[2]), y: corners.map((c) => c[3]), stroke: "full", dots: 1.4 }],
        { width: 330, height: 370, title: "corner residuals, px", xLabel: "x, px" })),
      element("figure", {}, lineChart([{ x: views.map((_, i) => i + 1), y: views.map((v) => v.rms_px), stroke: "full", dots: 3 }],
        { width: 270, height: 370, title: "RMS of each view, px", xLabel: "view", yRange: [0, extent(views.map((v) => v.rms_px))[1] * 1.2], xRange: [0, views.length + 1] }))),
    calibration.projection_sigma_px.length ? element("figure", {}, uncertaintyMap(calibration),
      element("figcaption", {}, `A far point's deviation, both directions together, less what a turn of the whole camera would make up for. Corners of boards lie in ${fixed(100 * calibration.coverage, 0)} % of the image's cells.`)) : null,
    element("details", {}, element("summary", {}, "Deviations of the parameters"),
      table(["parameter", number("deviation")], Object.entries(sigmas).map(([parameter, sigma]) => ({ cells: [parameter, number(known(sigma) ? sigma.toPrecision(3) : "–")] }))))];
}

function calibrationSection(calibrations) {
  if (!calibrations.length) return;
  section("calibration", "Calibration", "What is left of the chessboards' corners after the joint fit.", calibrations.map(calibrationView));
}
