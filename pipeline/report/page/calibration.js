// Residuals and uncertainty of calibrations.

const residualScale = 100;

// Residual vectors at the corners, magnified.
function residualField(calibration) {
  const { corners, width, height } = calibration, lines = { x: [], y: [] };
  for (const [u, v, du, dv] of corners) {
    lines.x.push(u, u + residualScale * du, null);
    lines.y.push(v, v + residualScale * dv, null);
  }
  return lineChart([{ ...lines, stroke: "full", width: 1 }, { x: corners.map((c) => c[0]), y: corners.map((c) => c[1]), stroke: "soft", dots: 1 }],
    { width: 480, height: 370, title: `residuals in the image, ${residualScale} times enlarged`, xLabel: "x, px", xRange: [0, width], yRange: [height, 0] });
}

// Standard deviation of the projection of a distant point, on a grid over the image.
function uncertaintyMap({ projection_sigma_px: rows, width, height }) {
  const box = { left: 8, top: 24, width: 480, height: (480 * height) / width };
  const highest = extent(rows.flat())[1], [across, down] = [box.width / rows[0].length, box.height / rows.length];
  const svg = svgElement("svg", { viewBox: `0 0 ${box.width + 16} ${box.height + 32}`, width: box.width + 16, height: box.height + 32, role: "img", style: "max-width:100%;height:auto" });
  svg.append(svgElement("text", { class: "title", x: box.left, y: box.top - 8 }, "projection uncertainty, px"));
  rows.forEach((row, j) => row.forEach((sigma, i) => {
    const [x, y, level] = [box.left + i * across, box.top + j * down, known(sigma) ? sigma / highest : 0];
    svg.append(svgElement("rect", { x, y, width: across, height: down, fill: `rgb(${heat(level).map(Math.round).join(" ")})` }),
      svgElement("text", { x: x + across / 2, y: y + down / 2 + 4, "text-anchor": "middle", style: `fill:${level > 0.6 ? "#000" : "#fff"}` }, fixed(sigma, 2)));
  }));
  return svg;
}

function calibrationView(calibration) {
  const digits = (value) => number(known(value) ? value.toPrecision(3) : "–");
  const { name, corners, views, sigmas } = calibration;
  const depth = calibration.depth_rms_m > 0 ? `, RMS depth error ${fixed(1000 * calibration.depth_rms_m, 2)} mm` : "";
  const print = calibration.deformation_sigma_m > 0 ? ` The board deviates from its nominal geometry by ${fixed(1000 * calibration.deformation_sigma_m, 3)} mm per corner (estimated with the camera).` : "";
  const together = calibration.view_inflation > 1 ? ` Corners of a view err together: standard deviations are ${fixed(calibration.view_inflation, 1)} times those of independent corners.` : "";
  return [element("h3", {}, name),
    element("p", {}, `RMS reprojection error ${fixed(calibration.rms_px, 3)} px${depth}.${print}${together} Verdict: ${calibration.verdict}. ${calibration.advice.join(" ")}`),
    element("div", { class: "figures" }, element("figure", {}, residualField(calibration)),
      element("figure", {}, lineChart([{ x: corners.map((c) => c[2]), y: corners.map((c) => c[3]), stroke: "full", dots: 1.4 }],
        { width: 330, height: 370, title: "corner residuals, px", xLabel: "x, px" })),
      element("figure", {}, lineChart([{ x: views.map((_, i) => i + 1), y: views.map((v) => v.rms_px), stroke: "full", dots: 3 }],
        { width: 270, height: 370, title: "RMS per view, px", xLabel: "view", yRange: [0, extent(views.map((v) => v.rms_px))[1] * 1.2], xRange: [0, views.length + 1] }))),
    calibration.projection_sigma_px.length ? element("figure", {}, uncertaintyMap(calibration),
      element("figcaption", {}, `Standard deviation of the projection of a distant point, both axes combined, after removing a rotation of the camera. ${known(calibration.coverage) ? `Board corners cover ${fixed(100 * calibration.coverage, 0)} % of the image cells.` : ""}`)) : null,
    element("details", {}, element("summary", {}, "Standard deviations of the parameters"),
      table(["parameter", number("standard deviation"), number("if corners were independent")], Object.entries(sigmas).map(([parameter, sigma]) => ({ cells: [parameter, digits(sigma), digits(calibration.independent_sigmas[parameter])] }))))];
}

function calibrationSection(calibrations) {
  if (!calibrations.length) return;
  section("calibration", "Calibration", "Residuals of the board corners after the joint optimisation.", calibrations.map(calibrationView));
}
