// Line charts in SVG.
// series: {x, y, stroke: name of a colour, dash, band: [low, high], opacity: of the band, dots: radius, labels: of the dots}; null: gap.

function niceTicks(from, to, count) {
  const low = Math.min(from, to), high = Math.max(from, to);
  const raw = (high - low) / count || 1;
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999);
  const ticks = [];
  for (let v = Math.ceil(low / step) * step; v <= high + step * 1e-9; v += step) ticks.push(Math.abs(v) < step * 1e-9 ? 0 : v);
  return { ticks, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const v of values) if (known(v)) { low = Math.min(low, v); high = Math.max(high, v); }
  return low <= high ? [low, high] : [0, 1];
}

function axisRange(values, fixedRange) {
  if (fixedRange) return fixedRange;
  const [low, high] = extent(values);
  const margin = (high - low) * 0.06 || Math.abs(high) * 0.1 || 1;
  return [low - margin, high + margin];
}

function pathOf(x, y, sx, sy) {
  let path = "", pen = "M";
  for (let i = 0; i < x.length; i++) {
    if (!known(x[i]) || !known(y[i])) { pen = "M"; continue; }
    path += `${pen}${sx(x[i]).toFixed(1)} ${sy(y[i]).toFixed(1)}`;
    pen = "L";
  }
  return path;
}

function bandPath(x, [low, high], sx, sy) {
  const forward = x.map((v, i) => `${sx(v).toFixed(1)} ${sy(high[i]).toFixed(1)}`);
  const back = x.map((v, i) => `${sx(v).toFixed(1)} ${sy(low[i]).toFixed(1)}`).reverse();
  return "M" + forward.concat(back).join("L") + "Z";
}

function drawAxes(svg, box, xRange, yRange, sx, sy, options) {
  const xs = niceTicks(xRange[0], xRange[1], Math.max(2, box.width / 70)), ys = niceTicks(yRange[0], yRange[1], Math.max(2, box.height / 30));
  for (const v of ys.ticks) {
    svg.append(svgElement("line", { class: "grid", x1: box.left, x2: box.left + box.width, y1: sy(v), y2: sy(v) }));
    svg.append(svgElement("text", { x: box.left - 5, y: sy(v) + 4, "text-anchor": "end" }, v.toFixed(ys.digits)));
  }
  for (const v of xs.ticks)
    svg.append(svgElement("text", { x: sx(v), y: box.top + box.height + 15, "text-anchor": "middle" }, v.toFixed(xs.digits)));
  svg.append(svgElement("rect", { class: "frame", x: box.left, y: box.top, width: box.width, height: box.height }));
  if (options.title) svg.append(svgElement("text", { class: "title", x: box.left, y: box.top - 8 }, options.title));
  if (options.xLabel) svg.append(svgElement("text", { x: box.left + box.width / 2, y: box.top + box.height + 31, "text-anchor": "middle" }, options.xLabel));
  if (options.yLabel) svg.append(svgElement("text", { transform: `translate(12 ${box.top + box.height / 2}) rotate(-90)`, "text-anchor": "middle" }, options.yLabel));
}

function drawSeries(svg, series, sx, sy) {
  if (series.band) svg.append(svgElement("path", { d: bandPath(series.x, series.band, sx, sy), style: `fill:var(--${series.stroke})`, "fill-opacity": series.opacity || 0.16 }));
  if (series.dots) {
    series.x.forEach((v, i) => known(v) && known(series.y[i]) &&
      svg.append(svgElement("circle", { cx: sx(v).toFixed(1), cy: sy(series.y[i]).toFixed(1), r: series.dots, style: `fill:var(--${series.stroke})`, "fill-opacity": 0.55 })));
    (series.labels || []).forEach((text, i) => svg.append(svgElement("text", { x: sx(series.x[i]) + 6, y: sy(series.y[i]) + 4 }, text)));
  } else {
    svg.append(svgElement("path", { d: pathOf(series.x, series.y, sx, sy), fill: "none", style: `stroke:var(--${series.stroke})`, "stroke-width": series.width || 1.8, "stroke-dasharray": series.dash || "none", "stroke-linejoin": "round" }));
  }
}

let clipCount = 0;

function lineChart(series, options = {}) {
  const width = options.width || 520, height = options.height || 260;
  const box = { left: 54, top: options.title ? 24 : 8, width: width - 66, height: height - (options.title ? 24 : 8) - (options.xLabel ? 38 : 22) };
  const xRange = options.xRange || extent(series.flatMap((s) => s.x));
  const yRange = axisRange(series.flatMap((s) => s.y.concat(...(s.band || []))), options.yRange);
  const sx = (v) => box.left + ((v - xRange[0]) / (xRange[1] - xRange[0] || 1)) * box.width;
  const sy = (v) => box.top + (1 - (v - yRange[0]) / (yRange[1] - yRange[0] || 1)) * box.height;
  const svg = svgElement("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", style: "max-width:100%;height:auto" });
  drawAxes(svg, box, xRange, yRange, sx, sy, options);
  const id = `clip${++clipCount}`;
  const clip = svgElement("clipPath", { id });
  clip.append(svgElement("rect", { x: box.left, y: box.top, width: box.width, height: box.height }));
  const inside = svgElement("g", { "clip-path": `url(#${id})` });
  for (const level of options.levels || []) inside.append(svgElement("line", { x1: box.left, x2: box.left + box.width, y1: sy(level), y2: sy(level), style: "stroke:var(--soft)", "stroke-dasharray": "2 3" }));
  for (const one of series) drawSeries(inside, one, sx, sy);
  const cursor = svgElement("line", { y1: box.top, y2: box.top + box.height, style: "stroke:var(--soft)", visibility: "hidden" });
  svg.append(clip, inside, cursor);
  svg.moveCursor = (x) => {
    const shown = x >= xRange[0] && x <= xRange[1];
    cursor.setAttribute("visibility", shown ? "visible" : "hidden");
    if (shown) { cursor.setAttribute("x1", sx(x)); cursor.setAttribute("x2", sx(x)); }
  };
  return svg;
}
