// Builds the page from the embedded data. Missing inputs have no section.

function provenanceSection(artefacts) {
  if (!artefacts.length) return;
  section("provenance", "Provenance", "How each file was made: command, options, seed, hashes of the inputs, device, version.",
    artefacts.map(({ artefact, provenance }) => element("details", {},
      element("summary", {}, `${artefact} — ${provenance.command || provenance.verb || ""}, ${provenance.created || ""}`),
      element("pre", {}, JSON.stringify(provenance, null, 2)))));
}

// An error in one section must not hide the others.
function draw(addSection, ...data) {
  try {
    addSection(...data);
  } catch (error) {
    document.getElementById("main").append(element("p", { class: "error" }, `A section of this report could not be drawn: ${error.message}`));
  }
}

function build() {
  window.addEventListener("error", (event) => draw(() => { throw new Error(event.message); }));
  const data = JSON.parse(document.getElementById("data").textContent), metrics = data.metrics;
  document.getElementById("subtitle").textContent = [data.title, `touchtrace ${data.version}`, data.created, metrics && metrics.device].filter(Boolean).join(" · ");
  if (metrics) for (const addSection of [resultSection, optionSection, exampleSection, horizonSection]) draw(addSection, metrics);
  draw(runTimeSection, data);
  if (metrics) draw(labelErrorSection, metrics);
  draw(smoothingSection, data.smoothing);
  draw(calibrationSection, data.calibrations);
  draw(figuresSection, data.figures);
  draw(provenanceSection, data.artefacts);
}

build();
