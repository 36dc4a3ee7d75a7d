// Builds the page from the data beside it. What was not given has no section.

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
