// 3-D paths on a canvas, rotated by dragging. Colours are read when drawing, so they follow the theme.
// paths: {points: [[x, y, z]...], radii: [r...] or null, stroke, dash}; metres in the camera frame (y down).

function boundsOf(paths) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const { points } of paths)
    for (const p of points) p.forEach((v, i) => { low[i] = Math.min(low[i], v); high[i] = Math.max(high[i], v); });
  const centre = low.map((v, i) => (v + high[i]) / 2);
  return { low, high, centre, size: Math.max(...high.map((v, i) => v - low[i]), 0.05) };
}

function projector(bounds, view, width, height) {
  const scale = (0.62 * Math.min(width, height)) / bounds.size;
  const [cy, sy, cp, sp] = [Math.cos(view.yaw), Math.sin(view.yaw), Math.cos(view.pitch), Math.sin(view.pitch)];
  const project = ([px, py, pz]) => {
    const [x, y, z] = [px - bounds.centre[0], py - bounds.centre[1], pz - bounds.centre[2]];
    const [u, w] = [cy * x + sy * z, -sy * x + cy * z];
    return [width / 2 + scale * u, height / 2 + scale * (cp * y + sp * w)];
  };
  return { project, scale };
}

function drawBox(context, bounds, project) {
  const corner = (i) => [0, 1, 2].map((axis) => ((i >> axis) & 1 ? bounds.high : bounds.low)[axis]);
  context.strokeStyle = color("line");
  context.setLineDash([]);
  context.lineWidth = 1;
  for (let i = 0; i < 8; i++)
    for (let axis = 0; axis < 3; axis++) {
      if ((i >> axis) & 1) continue;
      context.beginPath();
      context.moveTo(...project(corner(i)));
      context.lineTo(...project(corner(i | (1 << axis))));
      context.stroke();
    }
}

// Marks of 5 or 10 cm along each axis, from the lowest corner.
function drawAxisMarks(context, bounds, project) {
  const length = bounds.size > 0.25 ? 0.1 : 0.05;
  context.fillStyle = color("soft");
  context.strokeStyle = color("soft");
  context.lineWidth = 2;
  context.font = "11px system-ui, sans-serif";
  ["x", "y", "z"].forEach((name, axis) => {
    const end = bounds.low.map((v, i) => (i === axis ? v + length : v));
    context.beginPath();
    context.moveTo(...project(bounds.low));
    context.lineTo(...project(end));
    context.stroke();
    const [u, v] = project(end);
    context.fillText(`${name} ${length * 100} cm`, u + 4, v - 4);
  });
}

function drawPath(context, path, { project, scale }) {
  const points = path.points.map(project), stroke = color(path.stroke);
  context.setLineDash([]);
  if (path.radii) {
    context.fillStyle = stroke;
    context.globalAlpha = 0.13;
    context.beginPath();  // one path, so that overlapping circles are not darker
    points.forEach(([u, v], i) => {
      context.moveTo(u + path.radii[i] * scale, v);
      context.arc(u, v, path.radii[i] * scale, 0, 2 * Math.PI);
    });
    context.fill();
    context.globalAlpha = 1;
  }
  context.strokeStyle = context.fillStyle = stroke;
  context.lineWidth = 2;
  context.setLineDash(path.dash || []);
  context.beginPath();
  points.forEach(([u, v], i) => (i ? context.lineTo(u, v) : context.moveTo(u, v)));
  context.stroke();
  context.setLineDash([]);
  context.beginPath();
  context.arc(...points[0], 3.5, 0, 7);
  context.fill();
}

function pathView(paths, width = 430, height = 360) {
  const ratio = window.devicePixelRatio || 1;
  const canvas = element("canvas", { class: "paths", width: width * ratio, height: height * ratio, style: `width:${width}px;height:${height}px`, "aria-label": "paths in 3-D; drag to rotate" });
  const bounds = boundsOf(paths), view = { yaw: 0.7, pitch: 0.45 };
  const draw = () => {
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const projection = projector(bounds, view, width, height);
    drawBox(context, bounds, projection.project);
    drawAxisMarks(context, bounds, projection.project);
    for (const path of paths) drawPath(context, path, projection);
  };
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (!event.buttons) return;
    view.yaw += event.movementX * 0.01;
    view.pitch = Math.max(-1.5, Math.min(1.5, view.pitch + event.movementY * 0.01));
    draw();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  draw();
  return canvas;
}
