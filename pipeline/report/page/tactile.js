// Tactile frames as a heat map with a time slider.

const heatStops = [[24, 26, 48], [59, 52, 128], [140, 60, 130], [222, 94, 82], [250, 176, 66], [252, 250, 190]];

function heat(level) {
  const at = Math.min(Math.max(level, 0), 1) * (heatStops.length - 1), i = Math.min(Math.floor(at), heatStops.length - 2);
  return heatStops[i].map((v, c) => v + (heatStops[i + 1][c] - v) * (at - i));
}

function drawFrame(canvas, frames, index) {
  const { rows, cols, bytes, scale } = frames;
  const image = new ImageData(cols, rows);
  for (let i = 0; i < rows * cols; i++) {
    const [r, g, b] = heat(bytes[index * rows * cols + i] / scale);
    image.data.set([r, g, b, 255], i * 4);
  }
  canvas.getContext("2d").putImageData(image, 0, 0);
}

// tactile: {rows, cols, first_step, data: base64 of bytes [frames, rows, cols]}; onStep(step): called with the step shown.
function tactileView(tactile, rateHz, onStep) {
  const bytes = Uint8Array.from(atob(tactile.data), (c) => c.charCodeAt(0));
  const frames = { rows: tactile.rows, cols: tactile.cols, bytes, scale: bytes.reduce((a, b) => Math.max(a, b), 1) };
  const count = bytes.length / (frames.rows * frames.cols);
  const canvas = element("canvas", { class: "tactile", width: frames.cols, height: frames.rows, style: "width:256px;height:256px" });
  const slider = element("input", { type: "range", min: 0, max: count - 1, value: -tactile.first_step, "aria-label": "tactile frame" });
  const caption = element("span");
  const show = () => {
    const step = Number(slider.value) + tactile.first_step;
    drawFrame(canvas, frames, Number(slider.value));
    caption.textContent = `${(step / rateHz).toFixed(2)} s`;
    onStep(step);
  };
  slider.addEventListener("input", show);
  show();
  return element("figure", { style: "width:258px" }, canvas, element("div", { class: "control" }, slider, caption),
    element("figcaption", {}, "tactile frames; 0 s: start of the roll-out; earlier frames: its first window"));
}
