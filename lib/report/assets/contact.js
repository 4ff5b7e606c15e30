"use strict";
// Animation and plots of a scene of contact. Data: see contact_page.cpp.
const D = JSON.parse(document.getElementById("data").textContent);
const byId = id => document.getElementById(id);
const canvas = byId("view"), pen = canvas.getContext("2d");
const slider = byId("frame"), play = byId("play"), arrows = byId("arrows"), size = byId("force"), scale = byId("scale"), colours = byId("colour");
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const N = D.bodies.length, F = D.frames.length;

// Extent over all frames. A few bodies that left far away do not shrink the rest; many are followed.
let low = [1e300, 1e300], high = [-1e300, -1e300], bent = 0;
const forces = [], moving = [], sizes = [];
const grow = (x, y) => { low = [Math.min(low[0], x), Math.min(low[1], y)]; high = [Math.max(high[0], x), Math.max(high[1], y)]; };
D.bodies.forEach((b, k) => {
  let area = 0;
  for (let i = 0; i < b.o.length; i += 2) {
    const j = (i + 2) % b.o.length;
    area += b.o[i] * b.o[j + 1] - b.o[j] * b.o[i + 1];
    grow(b.c[0] + b.o[i], b.c[1] + b.o[i + 1]);
  }
  if (!b.f) { moving.push(k); sizes.push(Math.sqrt(Math.abs(area) / 2)); }
});
const span = Math.max(high[0] - low[0], high[1] - low[1]) || 1, start = [low.slice(), high.slice()];
let reach = .5;
const near = (f, b) => [0, 1].every(k => f.p[3 * b + k] > start[0][k] - reach * span && f.p[3 * b + k] < start[1][k] + reach * span);
while (reach < 1e3 && moving.filter(b => !D.frames.every(f => near(f, b))).length > moving.length / 10) reach *= 1.5;
for (const f of D.frames) {
  for (const b of moving) {
    if (!near(f, b)) continue;
    const o = D.bodies[b].o, c = Math.cos(f.p[3 * b + 2]), s = Math.sin(f.p[3 * b + 2]);
    for (let i = 0; i < o.length; i += 2) grow(f.p[3 * b] + c * o[i] - s * o[i + 1], f.p[3 * b + 1] + s * o[i] + c * o[i + 1]);
  }
  for (const b in f.d) for (const v of f.d[b]) bent = Math.max(bent, Math.abs(v));
  for (let i = 0; i < f.c.length; i += 5) forces.push(Math.hypot(f.c[i + 2], f.c[i + 3]));
}
// Lines are scaled by what most contacts carry: an impact would make those of all the others points.
const ofAll = (values, part) => values.length ? values.slice().sort((a, b) => a - b)[Math.floor(part * (values.length - 1))] : 0;
const largest = forces.reduce((m, v) => Math.max(m, v), 0), most = ofAll(forces.filter(v => v > 1e-6 * largest), .9), longest = 2.5;
const typical = ofAll(sizes, .5) || span;
const whole = Math.max(high[0] - low[0], high[1] - low[1]) || 1, usual = bent > 0 ? Math.max(1, Math.min(.03 * whole, .08 * typical) / bent) : 1;
if (!(bent > 0)) scale.parentNode.style.display = "none";
if (F < 2) byId("player").style.display = "none";
if (!forces.length) for (const part of [arrows.parentNode, size.parentNode, byId("states")]) part.style.display = "none";
if (!D.bodies.some(b => b.f)) byId("fixed").style.display = "none";
slider.max = F - 1;
slider.value = 0; // the state before anything moved

function ramp(t) {
  const s = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  t = Math.min(.9999, Math.max(0, t)) * 4;
  const i = Math.floor(t), f = t - i;
  return "rgb(" + [0, 1, 2].map(k => Math.round(s[i][k] * (1 - f) + s[i + 1][k] * f)).join(",") + ")";
}
function shade(b, f, kind) {
  if (kind === "rotation") return ramp(.5 + f.p[3 * b + 2] / (2 * D.turned || 1));
  if (kind === "displacement") return ramp(Math.hypot(f.p[3 * b] - D.bodies[b].c[0], f.p[3 * b + 1] - D.bodies[b].c[1]) / (D.moved || 1));
  return "#d9c9a8";
}
// The next smaller 1, 2 or 5 times a power of ten.
const round = v => { const p = Math.pow(10, Math.floor(Math.log10(v))); return p * (v >= 5 * p ? 5 : v >= 2 * p ? 2 : 1); };
function label(text, x, y, taken, width) {
  const w = pen.measureText(text).width;
  const boxes = [[6, -6], [6, 16], [-6 - w, -6], [-6 - w, 16], [6, -20], [6, 30], [-6 - w, -20], [-6 - w, 30]].map(d => [x + d[0], y + d[1] - 11, x + d[0] + w, y + d[1] + 3]);
  const free = b => b[0] >= 0 && b[2] <= width && b[1] >= 0 && !taken.some(t => b[0] < t[2] && t[0] < b[2] && b[1] < t[3] && t[1] < b[3]);
  const box = boxes.find(free) || boxes[0];
  taken.push(box);
  pen.strokeText(text, box[0], box[3] - 3);
  pen.fillText(text, box[0], box[3] - 3);
}
function draw() {
  const width = canvas.clientWidth, pad = .04 * whole, foot = 34;
  const tall = foot + Math.round(Math.min(window.innerHeight * .75, Math.max(200, width * (high[1] - low[1] + 2 * pad) / (high[0] - low[0] + 2 * pad))));
  const ratio = window.devicePixelRatio || 1;
  canvas.width = width * ratio; canvas.height = tall * ratio; canvas.style.height = tall + "px";
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, tall);
  const k = Math.min(width / (high[0] - low[0] + 2 * pad), (tall - foot) / (high[1] - low[1] + 2 * pad));
  const X = x => width / 2 + (x - (low[0] + high[0]) / 2) * k, Y = y => (tall - foot) / 2 - (y - (low[1] + high[1]) / 2) * k;
  const f = D.frames[Math.min(+slider.value, F - 1)], bend = usual * Math.pow(10, +scale.value);
  const wall = css("--wall"), edge = css("--edge"), ink = css("--ink"), kind = colours.value;
  byId("time").textContent = show(f.t) + " s";
  byId("bent").textContent = "\u00d7 " + show(bend);
  byId("ramp").hidden = kind === "plain";
  const most_turned = show(D.turned * 180 / Math.PI) + "\u00b0";
  byId("ramp-low").textContent = kind === "rotation" && D.turned > 0 ? "\u2212" + most_turned : "0";
  byId("ramp-high").textContent = kind === "rotation" ? most_turned : show(D.moved) + " m";
  pen.lineJoin = "round";
  for (let b = 0; b < N; b++) {
    const body = D.bodies[b], c = Math.cos(f.p[3 * b + 2]), s = Math.sin(f.p[3 * b + 2]), d = f.d[b];
    pen.beginPath();
    for (let i = 0; i < body.o.length; i += 2) {
      const x = f.p[3 * b] + c * body.o[i] - s * body.o[i + 1] + (d ? bend * d[i] : 0);
      const y = f.p[3 * b + 1] + s * body.o[i] + c * body.o[i + 1] + (d ? bend * d[i + 1] : 0);
      i ? pen.lineTo(X(x), Y(y)) : pen.moveTo(X(x), Y(y));
    }
    pen.closePath();
    pen.fillStyle = body.f ? wall : shade(b, f, kind);
    pen.fill();
    pen.strokeStyle = edge;
    pen.lineWidth = N > 400 ? .4 : 1;
    pen.stroke();
  }
  // Half as long as a body is wide, for what most contacts carry.
  const half = Math.min(.12 * Math.min(width, tall), Math.max(6, .5 * typical * k)) * Math.pow(10, +size.value);
  if (arrows.checked && most > 0) {
    const dot = Math.min(2.4, Math.max(.8, .05 * typical * k));
    for (let i = 0; i < f.c.length; i += 5) {
      const of = half / most * Math.min(1, longest * most / Math.hypot(f.c[i + 2], f.c[i + 3]));
      const x = X(f.c[i]), y = Y(f.c[i + 1]), dx = of * f.c[i + 2], dy = -of * f.c[i + 3];
      pen.strokeStyle = pen.fillStyle = f.c[i + 4] ? "#d1495b" : "#1f5f8b";
      pen.lineWidth = N > 400 ? 1 : 1.6;
      pen.beginPath(); pen.moveTo(x - dx, y - dy); pen.lineTo(x + dx, y + dy); pen.stroke();
      pen.beginPath(); pen.arc(x, y, dot, 0, 7); pen.fill();
    }
  }
  pen.font = "12px system-ui, sans-serif";
  pen.fillStyle = ink;
  const taken = D.points.map(p => { const x = X(p.x + f.u[p.k][0]), y = Y(p.y + f.u[p.k][1]); return [x - 3, y - 3, x + 3, y + 3]; });
  for (const t of taken) { pen.beginPath(); pen.arc(t[0] + 3, t[1] + 3, 3.5, 0, 7); pen.fill(); }
  pen.strokeStyle = css("--sheet");
  pen.lineWidth = 3;
  D.points.forEach((p, i) => label(p.n, taken[i][0] + 3, taken[i][1] + 3, taken, width));
  // Rulers: metres, and the force of a line.
  const ruler = (x, length, text, colour) => {
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    pen.beginPath(); pen.moveTo(x, tall - 8); pen.lineTo(x + length, tall - 8); pen.stroke();
    pen.fillText(text, x + length + 6, tall - 4);
    return x + length + 34 + pen.measureText(text).width;
  };
  const metres = round(120 / k);
  const next = ruler(8, metres * k, show(metres) + " m", ink);
  if (arrows.checked && most > 0) {
    const force = round(100 / (2 * half) * most);
    ruler(next, force * 2 * half / most, show(force / 1e3) + " kN/m", "#1f5f8b");
  }
}
for (const control of [slider, arrows, size, scale, colours]) control.addEventListener("input", draw);
let timer = null;
play.addEventListener("click", () => {
  if (timer) { clearInterval(timer); timer = null; play.textContent = "Play"; return; }
  if (+slider.value >= F - 1) slider.value = 0;
  play.textContent = "Stop";
  timer = setInterval(() => { slider.value = (+slider.value + 1) % F; draw(); }, 50);
});

const chart = (id, series, yl, options = {}) => chart2d(id, series, D.way, yl, { from: D.history[0][0], ...options });
const H = D.history, column = k => H.map(r => [r[0], r[k]]);
function plots() {
  if (H.length < 2) return;
  const path = axis => D.points.map(p => ({ n: p.n, p: H.map(r => [r[0], r[10 + 2 * p.k + axis]]) }));
  chart("ux", path(0), "x displacement (m)", { least: 1e-9 * span });
  chart("uy", path(1), "y displacement (m)", { least: 1e-9 * span });
  const peak = H.reduce((m, r) => Math.max(m, ...r.slice(1, 7).map(Math.abs)), 0);
  const unit = peak >= 2e6 ? [1e6, "MJ/m"] : peak >= 2e3 ? [1e3, "kJ/m"] : [1, "J/m"];
  chart("energy", ["kinetic", "elastic", "gravity", "work of loads", "friction", "lost otherwise"].map((n, k) => ({ n: n, p: column(k + 1).map(p => [p[0], p[1] / unit[0]]) })), "energy (" + unit[1] + ")");
  // The first row is the start, before any step.
  chart("steps", [{ n: "", p: column(7).slice(1) }], "step (s)", { zero: true });
  chart("iterations", [{ n: "", p: column(8).slice(1) }], "iterations in a step", { zero: true, count: true });
  chart("contacts", [{ n: "", p: column(9).slice(1) }], "contacts that carry", { zero: true, count: true });
}
function all() { draw(); plots(); }
window.addEventListener("resize", all);
all();
