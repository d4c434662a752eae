"use strict";
// Draws terrain, routes and, slot by slot, UAVs and links. `SCENE` is the data of this run.
(function () {
  const BANDS = [
    { name: "margin below 1 dB", below: 1, color: "#D55E00", dash: "dot", width: 7 },
    { name: "1 to 6 dB", below: 6, color: "#8C6D1F", dash: "dash", width: 5 },
    { name: "above 6 dB", below: Infinity, color: "#0072B2", dash: "solid", width: 4 },
  ];
  const SYMBOLS = ["circle", "square", "diamond", "cross", "x", "circle-open", "square-open", "diamond-open"];
  const scene = document.getElementById("scene");
  const slider = document.getElementById("slot");
  const picker = document.getElementById("algorithm");
  const facts = document.getElementById("slot-facts");
  const play = document.getElementById("play");

  const traces = [{
    type: "surface", x: SCENE.terrain.x, y: SCENE.terrain.y, z: SCENE.terrain.z,
    colorscale: [[0, "#9fb08f"], [0.5, "#d9cfb4"], [1, "#f2ece2"]], showscale: false,
    lighting: { ambient: 0.55, diffuse: 0.8, specular: 0.05, roughness: 0.9 },
    lightposition: { x: -20000, y: 20000, z: 20000 },
    contours: { z: { show: true, color: "#8a7f6a", width: 1, usecolormap: false } },
    hovertemplate: "ground %{z:.0f} m<extra></extra>", name: "ground",
  }];
  SCENE.area.forEach((ring) => traces.push({
    type: "scatter3d", mode: "lines", name: "area", showlegend: false, hoverinfo: "skip",
    x: ring.map((p) => p[0]), y: ring.map((p) => p[1]), z: ring.map((p) => p[2]),
    line: { color: "#1c2430", width: 4, dash: "dash" },
  }));
  SCENE.fence.forEach((zone) => traces.push({
    type: "surface", x: zone.x, y: zone.y, z: zone.z, opacity: 0.35, showscale: false, hoverinfo: "name",
    colorscale: [[0, "#A50034"], [1, "#A50034"]], name: zone.name,
  }));
  SCENE.uavs.forEach((uav) => traces.push({
    type: "scatter3d", mode: "lines", name: uav.id + " flight",
    x: uav.path.map((p) => p[0]), y: uav.path.map((p) => p[1]), z: uav.path.map((p) => p[2]),
    line: { color: uav.color, width: 3 }, opacity: 0.75, legendgroup: uav.id, showlegend: false, hoverinfo: "skip",
  }, {
    type: "scatter3d", mode: "markers", name: uav.id + " route",
    x: uav.route.map((p) => p[0]), y: uav.route.map((p) => p[1]), z: uav.route.map((p) => p[2]),
    marker: { color: uav.color, size: 2.2 }, opacity: 0.75,
    legendgroup: uav.id, showlegend: false, hovertemplate: uav.id + "<br>%{text}<extra></extra>",
    text: uav.route.map((p, i) => (i ? "waypoint " + uav.waypoints[i - 1] + ", " + uav.arrival[i - 1].toFixed(0) + " s" : "pad")),
  }));
  const FLOWN = SCENE.flown;
  if (FLOWN) {
    FLOWN.tracks.forEach((track, a) => traces.push({
      type: "scatter3d", mode: "lines", name: SCENE.uavs[a].id + " as flown", legendgroup: SCENE.uavs[a].id,
      x: track.map((p) => p[0]), y: track.map((p) => p[1]), z: track.map((p) => p[2]),
      line: { color: SCENE.uavs[a].color, width: 5 }, showlegend: false, hoverinfo: "skip",
    }));
    traces.forEach((trace) => { if ((trace.name || "").endsWith(" flight")) { trace.opacity = 0.35; } });
    slider.max = Math.max(SCENE.positions.length, FLOWN.positions.length) - 1;
  }
  const firstLink = traces.length;
  BANDS.forEach((band) => traces.push({
    type: "scatter3d", mode: "lines", name: band.name, x: [null], y: [null], z: [null],
    line: { color: band.color, width: band.width, dash: band.dash }, hoverinfo: "skip",
  }));
  const firstUav = traces.length;
  SCENE.uavs.forEach((uav, a) => traces.push({
    type: "scatter3d", mode: "markers+text", name: uav.id, legendgroup: uav.id,
    x: [null], y: [null], z: [null], text: [uav.id], textposition: "top center",
    textfont: { size: 15, color: "#1c2430" },
    marker: { color: uav.color, size: 9, symbol: SYMBOLS[a % SYMBOLS.length], line: { color: "#ffffff", width: 1 } },
    hovertemplate: uav.id + "<br>%{x:.0f} m E, %{y:.0f} m N, %{z:.0f} m up<extra></extra>",
  }));

  // What is shown of a slot: of the flight where it is picked, else of the plan.
  function view(slot) {
    const flown = FLOWN && picker.value === FLOWN.name;
    const source = flown ? FLOWN : {
      positions: SCENE.positions, links: SCENE.links[picker.value], throughput: SCENE.throughput[picker.value],
    };
    const n = Math.min(slot, source.positions.length - 1);
    return {
      n, last: source.positions.length - 1, positions: source.positions[n], links: source.links[n],
      throughput: source.throughput[n], time: flown ? FLOWN.begin[n] : n * SCENE.duration,
    };
  }

  function links(here) {
    const ends = BANDS.map(() => ({ x: [], y: [], z: [] }));
    here.links.forEach(([a, b, margin]) => {
      const band = ends[BANDS.findIndex((one) => margin < one.below)];
      [here.positions[a], here.positions[b], [null, null, null]].forEach((p) => {
        band.x.push(p[0]); band.y.push(p[1]); band.z.push(p[2]);
      });
    });
    return ends;
  }

  function show() {
    const slot = Number(slider.value);
    const shown = view(slot);
    const ends = links(shown);
    const at = shown.positions;
    const x = [], y = [], z = [], which = [];
    ends.forEach((band, i) => { x.push(band.x); y.push(band.y); z.push(band.z); which.push(firstLink + i); });
    at.forEach((p, a) => { x.push([p[0]]); y.push([p[1]]); z.push([p[2]]); which.push(firstUav + a); });
    if (inSpace) { Plotly.restyle(scene, { x, y, z }, which); }
    const here = shown.links;
    let text = "Slot " + shown.n + " of " + shown.last + " · " + shown.time.toFixed(0) +
      " s after lift-off · " + here.length + " links";
    if (here.length) {
      const weakest = here.reduce((worst, link) => (link[2] < worst[2] ? link : worst));
      text += " · weakest " + SCENE.uavs[weakest[0]].id + "–" + SCENE.uavs[weakest[1]].id + ", " + weakest[2].toFixed(1) + " dB to spare";
    }
    text += " · " + Math.round(shown.throughput).toLocaleString("en-US").replace(/,/g, " ") + " Mb/s";
    facts.textContent = text;
  }

  // Without WebGL nothing would be drawn, and nothing said.
  function hasWebgl() {
    try {
      const canvas = document.createElement("canvas");
      return Boolean(canvas.getContext("webgl") || canvas.getContext("experimental-webgl"));
    } catch (error) {
      return false;
    }
  }
  function showPicture() {
    const picture = document.querySelector("#figure-routes img");
    document.getElementById("flat").hidden = false;
    document.getElementById("handling").hidden = true;
    scene.className = "picture";
    scene.replaceChildren(...(picture ? [picture.cloneNode(true)] : []));
    show();
  }
  const inSpace = hasWebgl();

  const axis = { backgroundcolor: "#ffffff", gridcolor: "#e3e6ea", zerolinecolor: "#e3e6ea" };
  if (inSpace) {
    Plotly.newPlot(scene, traces, {
      margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: "#ffffff",
      legend: { x: 0.01, y: 0.99, bgcolor: "rgba(255,255,255,0.8)" },
      scene: {
        aspectmode: "data", camera: { eye: { x: -0.95, y: -1.3, z: 0.95 }, center: { x: 0, y: 0, z: -0.12 } },
        xaxis: Object.assign({ title: { text: "East (m)" } }, axis),
        yaxis: Object.assign({ title: { text: "North (m)" } }, axis),
        zaxis: Object.assign({ title: { text: "Up (m)" } }, axis),
      },
    }, { responsive: true, displaylogo: false }).then(show);
  } else {
    showPicture();
  }

  slider.addEventListener("input", show);
  picker.addEventListener("change", show);
  let timer = null;
  play.addEventListener("click", () => {
    if (timer) {
      clearInterval(timer);
      timer = null;
    } else {
      if (slider.value === slider.max) { slider.value = 0; }
      timer = setInterval(() => {
        slider.value = Number(slider.value) + 1;
        show();
        if (slider.value === slider.max) { play.click(); }
      }, 150);
    }
    play.textContent = timer ? "Pause" : "Play";
  });
})();
