// SPDX-License-Identifier: MIT
// Puts the page together. Whatever the run named freely is set as text, never as markup.

const byId = (id) => document.getElementById(id);

function showHeader(data) {
  document.title = `${data.name} – flotilla report`;
  byId("name").textContent = data.name;
  const verdictClass = { proved: "proved", failed: "failed" }[data.verdict] ?? "unsure";
  const verdict = element("span", `badge ${verdictClass}`,
    data.verdict === "proved" ? `verified: ${data.verdict_text}` : data.verdict === "failed" ? "verification FAILED"
      : data.verdict === "incomplete" ? "verification incomplete" : "not verified");
  verdict.title = data.verdict_text;
  const frames = data.track.frames.length;
  byId("badges").append(verdict, element("span", "badge", data.status),
    element("span", "badge", `${data.bodies.count} bodies`),
    element("span", "badge", frames === data.track.frames_in_run ? `${frames} frames`
      : `${frames} of ${data.track.frames_in_run} frames`));
  byId("problems").hidden = data.problems.length === 0;
  byId("problems").append(...data.problems.map((text) => element("li", "", text)));
}

function showTables(tables) {
  for (const { title, rows } of tables) {
    const card = element("div", `card${rows.some((row) => row.length > 2) ? " wide" : ""}`), table = element("table");
    for (const cells of rows) {
      const row = element("tr");
      row.append(...cells.map((text) => element("td", "", text)));
      table.append(row);
    }
    card.append(element("h2", "", title), table);
    byId("tables").append(card);
  }
}

function showCharts(data, player) {
  const columns = {};
  for (const [name, text] of Object.entries(data.plots)) columns[name] = floatsOf(text);
  const end = Math.max(player.end, columns.time?.at(-1) ?? 0);
  const span = [Math.min(player.start, columns.time?.[0] ?? player.start), end];
  if (span[1] <= span[0]) span[1] = span[0] + 1;
  const charts = CHARTS.map((spec) => new Chart(spec, columns, span, player)).filter((c) => c.series.length > 0);
  byId("charts").append(...charts.map((chart) => chart.card));
  const draw = () => charts.forEach((chart) => chart.draw());
  new ResizeObserver(draw).observe(byId("charts"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  return charts;
}

/** Lost frames in red below the slider. */
function showGaps(player) {
  const length = player.end - player.start;
  for (let i = 0; i + 1 < player.times.length; ++i) {
    if (!player.isGap(i)) continue;
    const mark = element("span");
    mark.style.left = `${(100 * (player.times[i] - player.start)) / length}%`;
    mark.style.width = `${(100 * (player.times[i + 1] - player.times[i])) / length}%`;
    mark.title = `frames ${player.frames[i] + 1} to ${player.frames[i + 1] - 1} are lost`;
    byId("gaps").append(mark);
  }
}

function attachControls(player, viewer) {
  const slider = byId("time");
  slider.min = player.start;
  slider.max = player.end;
  slider.addEventListener("input", () => player.seek(Number(slider.value)));
  byId("play").addEventListener("click", () => player.toggle());
  byId("speed").addEventListener("change", (event) => { player.speed = Number(event.target.value); });
  byId("loop").addEventListener("change", (event) => { player.loop = event.target.checked; });
  player.onChange(() => {
    slider.value = player.time;
    byId("play").textContent = player.playing ? "Pause" : "Play";
    const { frame } = player.place();
    byId("moment").textContent = player.times.length === 0 ? ""
      : `t = ${player.time.toFixed(3)} s · frame ${player.frames[frame]}${player.isGap(frame) ? ", the next ones are lost" : ""}`;
  });
  addEventListener("keydown", (event) => handleKey(event, player));
  if (viewer) attachViewControls(viewer);
}

function attachViewControls(viewer) {
  const set = (name, value) => { viewer.options[name] = value; viewer.stale = true; };
  byId("colour").addEventListener("change", (event) => {
    set("colour", event.target.value);
    byId("ramp").hidden = event.target.value !== "speed";
  });
  byId("ramp-middle").textContent = shortNumber(viewer.speedTop / 4); // the colours go with the root of the speed
  byId("ramp-top").textContent = `${shortNumber(viewer.speedTop)} m/s`;
  byId("fixed").addEventListener("change", (event) => set("fixed", event.target.value));
  byId("follow").addEventListener("change", (event) => set("follow", event.target.checked));
  byId("shadows").checked = viewer.options.shadows;
  byId("shadows").addEventListener("change", (event) => set("shadows", event.target.checked));
  byId("reset").addEventListener("click", () => { viewer.camera.reset(); viewer.stale = true; });
}

function handleKey(event, player) {
  if (event.target.closest("select, button, input:not([type=range])") || event.ctrlKey || event.altKey || event.metaKey) return;
  const step = event.shiftKey ? 10 : 1;
  const actions = {
    " ": () => player.toggle(),
    ArrowRight: () => player.stepFrames(step),
    ArrowLeft: () => player.stepFrames(-step),
    Home: () => player.seek(player.start),
    End: () => player.seek(player.end),
  };
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
}

function attachPicking(viewer, data) {
  const show = () => {
    const i = viewer.picked;
    byId("picked").textContent = i < 0 ? ""
      : !viewer.isThere(i) ? `${data.bodies.names[i]} (body ${data.bodies.indices[i]}), not there`
      : `${data.bodies.names[i]} (body ${data.bodies.indices[i]}), ${shortNumber(viewer.speedOf(i))} m/s, middle at (` +
        `${add(viewer.middleOf(i), data.track.origin).map((x) => shortNumber(x)).join(", ")}) m`;
  };
  attachPointers(viewer, (x, y) => {
    viewer.picked = viewer.bodyAt(x, y);
    viewer.stale = true;
    show();
  });
  viewer.player.onChange(show);
}

const SLOWEST = 0.06; // s per frame of an animation that still looks like one
const LEAST_DETAIL = 0.4;

/** Gives up resolution while playing where drawing is slow; a paused picture is always sharp. */
class DetailControl {
  constructor(viewer) {
    this.viewer = viewer;
    this.intervals = [];
  }

  afterFrame(playing, seconds) {
    if (!playing) this.set(1);
    else this.intervals.push(seconds);
    if (this.intervals.length < 4) return;
    const median = this.intervals.sort((a, b) => a - b)[2];
    const detail = this.viewer.detail;
    if (median > SLOWEST) this.set(Math.max(LEAST_DETAIL, detail * Math.sqrt(SLOWEST / median)));
    this.intervals = [];
  }

  set(detail) {
    if (this.viewer.detail !== detail) this.viewer.stale = true;
    this.viewer.detail = detail;
    this.intervals = [];
  }
}

/** Draws what changed, once per refresh of the screen, and counts while playing. */
function startLoop(player, viewer, charts) {
  let last = performance.now(), counted = 0, since = last, cursorsStale = false;
  const detail = viewer && new DetailControl(viewer);
  player.onChange(() => {
    if (viewer) viewer.stale = true;
    cursorsStale = true;
  });
  const loop = (now) => {
    player.advance(Math.min((now - last) / 1000, 0.25)); // a tab that slept does not jump
    detail?.afterFrame(player.playing, (now - last) / 1000);
    last = now;
    viewer?.draw();
    if (cursorsStale) charts.forEach((chart) => chart.showTime());
    cursorsStale = false;
    if (now - since > 1000) {
      const drawn = (viewer?.framesDrawn ?? 0) - counted;
      byId("rate").textContent = player.playing ? `${Math.round((1000 * drawn) / (now - since))} fps` : "";
      counted += drawn;
      since = now;
    }
    requestAnimationFrame(loop);
  };
  requestAnimationFrame(loop);
}

async function makeViewer(data, player) {
  const poses = await readPoses(byId("poses").textContent, data.track.frames.length, data.bodies.count);
  byId("poses").remove(); // tens of megabytes of text
  if (poses.length === 0) throw new Error("There is no frame to show.");
  const viewer = new Viewer(byId("view"), data, poses, player);
  viewer.draw();
  return viewer;
}

async function main() {
  const data = JSON.parse(byId("data").textContent);
  const player = new Player(data.track);
  showHeader(data);
  showTables(data.tables);
  showGaps(player);
  const charts = showCharts(data, player);
  let viewer = null;
  try {
    viewer = await makeViewer(data, player);
    byId("message").textContent = "";
    attachPicking(viewer, data);
  } catch (error) { // plots and tables are of use without it
    byId("message").textContent = error.message;
  }
  attachControls(player, viewer);
  startLoop(player, viewer, charts);
  player.changed();
  globalThis.flotillaReport = { player, viewer }; // for the console
  document.body.dataset.viewer = viewer ? "ready" : "absent";
}

await main();
