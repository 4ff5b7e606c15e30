"use strict";
// Animation and plots of a scene of contact. Data: see contact_page.cpp.
const D = JSON.parse(document.getElementById("data").textContent);
const byId = id => document.getElementById(id);
const canvas = byId("view"), pen = canvas.getContext("2d");
const slider = byId("frame"), play = byId("play"), arrows = byId("arrows"), size = byId("force"), scale = byId("scale"), colours = byId("colour");
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const show = v => v === 0 ? "0" : Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3 ? (+v.toPrecision(3)).toExponential() : String(+v.toPrecision(4));
const N = D.bodies.length, F = D.frames.length;

// Extent over all frames; bodies that left far away do not shrink the rest.
let low = [1e300, 1e300], high = [-1e300, -1e300], bent = 0;
const peaks = [];
const grow = (x, y) => { low = [Math.min(low[0], x), Math.min(low[1], y)]; high = [Math.max(high[0], x), Math.max(high[1], y)]; };
for (const b of D.bodies) for (let i = 0; i < b.o.length; i += 2) grow(b.c[0] + b.o[i], b.c[1] + b.o[i + 1]);
const span = Math.max(high[0] - low[0], high[1] - low[1]) || 1, start = [low.slice(), high.slice()];
for (const f of D.frames) {
  for (let b = 0; b < N; b++) {
    const x = f.p[3 * b], y = f.p[3 * b + 1];
    if (x > start[0][0] - span / 2 && x < start[1][0] + span / 2 && y > start[0][1] - span / 2 && y < start[1][1] + span / 2) grow(x, y);
    if (f.d[b]) for (const v of f.d[b]) bent = Math.max(bent, Math.abs(v));
  }
  let largest = 0;
  for (let i = 0; i < f.c.length; i += 5) largest = Math.max(largest, Math.hypot(f.c[i + 2], f.c[i + 3]));
  if (largest > 0) peaks.push(largest);
}
// Lines are scaled by what most frames have: an impact would make those of all the others points.
peaks.sort((a, b) => a - b);
const most = peaks.length ? peaks[Math.floor(.9 * (peaks.length - 1))] : 0, longest = 2.5;
const whole = Math.max(high[0] - low[0], high[1] - low[1]) || 1, usual = bent > 0 ? Math.max(1, 0.03 * whole / bent) : 1;
if (!(bent > 0)) scale.parentNode.style.display = "none";
if (F < 2) byId("player").style.display = "none";
slider.max = F - 1;
slider.value = F - 1;

function ramp(t) {
  const s = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  t = Math.min(.9999, Math.max(0, t)) * 4;
  const i = Math.floor(t), f = t - i;
  return "rgb(" + [0, 1, 2].map(k => Math.round(s[i][k] * (1 - f) + s[i + 1][k] * f)).join(",") + ")";
}
function shade(b, f) {
  if (D.bodies[b].f) return css("--wall");
  const kind = colours.value;
  if (kind === "rotation") return ramp(.5 + f.p[3 * b + 2] / (2 * D.turned || 1));
  if (kind === "displacement") return ramp(Math.hypot(f.p[3 * b] - D.bodies[b].c[0], f.p[3 * b + 1] - D.bodies[b].c[1]) / (D.moved || 1));
  return "#d9c9a8";
}
function draw() {
  const width = canvas.clientWidth, pad = .06 * whole;
  const tall = Math.round(Math.min(window.innerHeight * .75, Math.max(240, width * (high[1] - low[1] + 2 * pad) / (high[0] - low[0] + 2 * pad))));
  const ratio = window.devicePixelRatio || 1;
  canvas.width = width * ratio; canvas.height = tall * ratio; canvas.style.height = tall + "px";
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, tall);
  const k = Math.min(width / (high[0] - low[0] + 2 * pad), tall / (high[1] - low[1] + 2 * pad));
  const X = x => width / 2 + (x - (low[0] + high[0]) / 2) * k, Y = y => tall / 2 - (y - (low[1] + high[1]) / 2) * k;
  const f = D.frames[Math.min(+slider.value, F - 1)], bend = usual * Math.pow(10, +scale.value);
  byId("time").textContent = show(f.t) + " s";
  byId("bent").textContent = "x " + show(bend);
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
    pen.fillStyle = shade(b, f);
    pen.fill();
    pen.strokeStyle = css("--edge");
    pen.lineWidth = N > 400 ? .4 : 1;
    pen.stroke();
  }
  if (arrows.checked && most > 0) {
    const long = .12 * Math.min(width, tall) * Math.pow(10, +size.value) / most;
    for (let i = 0; i < f.c.length; i += 5) {
      const of = long * Math.min(1, longest * most / Math.hypot(f.c[i + 2], f.c[i + 3]));
      const x = X(f.c[i]), y = Y(f.c[i + 1]), dx = of * f.c[i + 2], dy = -of * f.c[i + 3];
      pen.strokeStyle = pen.fillStyle = f.c[i + 4] ? "#d1495b" : "#1f5f8b";
      pen.lineWidth = 1.6;
      pen.beginPath(); pen.moveTo(x - dx, y - dy); pen.lineTo(x + dx, y + dy); pen.stroke();
      pen.beginPath(); pen.arc(x, y, 2.4, 0, 7); pen.fill();
    }
  }
  pen.fillStyle = css("--ink");
  pen.font = "12px system-ui, sans-serif";
  for (const p of D.points) {
    const u = f.u[p.k], x = X(p.x + u[0]), y = Y(p.y + u[1]);
    pen.beginPath(); pen.arc(x, y, 3.5, 0, 7); pen.fill();
    pen.fillText(p.n, x + 6, y - 6);
  }
}
for (const control of [slider, arrows, size, scale, colours]) control.addEventListener("input", draw);
window.addEventListener("resize", draw);
let timer = null;
play.addEventListener("click", () => {
  if (timer) { clearInterval(timer); timer = null; play.textContent = "Play"; return; }
  if (+slider.value >= F - 1) slider.value = 0;
  play.textContent = "Stop";
  timer = setInterval(() => { slider.value = (+slider.value + 1) % F; draw(); }, 50);
});

function chart(id, series, xl, yl) {
  const el = byId(id);
  if (!el) return;
  const W = 640, H = 280, m = [14, 14, 40, 78], hue = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#666666"];
  let x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  for (const s of series) for (const p of s.p) { x0 = Math.min(x0, p[0]); x1 = Math.max(x1, p[0]); y0 = Math.min(y0, p[1]); y1 = Math.max(y1, p[1]); }
  if (!(x1 > x0)) { x0 -= .5; x1 += .5; }
  if (!(y1 > y0)) { const d = Math.abs(y0) || 1; y0 -= d / 2; y1 += d / 2; }
  // Ticks at 1, 2 or 5 times a power of ten; the y axis ends at one.
  const between = (a, b) => { const p = Math.pow(10, Math.floor(Math.log10((b - a) / 4))), s = (b - a) / 4 / p; return p * (s <= 1 ? 1 : s <= 2 ? 2 : s <= 5 ? 5 : 10); };
  const dx = between(x0, x1), dy = between(y0, y1), whole = (v, d) => Math.round(v / d) * d;
  y0 = Math.floor(y0 / dy + 1e-9) * dy; y1 = Math.ceil(y1 / dy - 1e-9) * dy;
  // Names stand above the plot, in as many lines as they need.
  let names = "", at = m[3], line = 0;
  series.forEach((s, i) => {
    if (!s.n) return;
    const wide = 34 + 6.6 * s.n.length;
    if (at > m[3] && at + wide > W - m[1]) { at = m[3]; ++line; }
    const c = hue[i % hue.length], y = 13 + 15 * line;
    names += '<path d="M' + at + ' ' + (y - 4) + 'h16" stroke="' + c + '" stroke-width="2"/><text x="' + (at + 20) + '" y="' + y + '" font-size="12" fill="currentColor">' + s.n.replace(/&/g, "&amp;").replace(/</g, "&lt;") + '</text>';
    at += wide;
  });
  if (names) m[0] += 8 + 15 * line;
  const X = v => m[3] + (v - x0) / (x1 - x0) * (W - m[1] - m[3]), Y = v => H - m[2] - (v - y0) / (y1 - y0) * (H - m[0] - m[2]);
  let out = '<svg viewBox="0 0 ' + W + ' ' + H + '" role="img" aria-label="' + yl + ' against ' + xl + '" style="max-width:100%">' + names;
  for (let v = y0; v < y1 + dy / 2; v += dy) {
    const py = Y(v);
    out += '<path d="M' + m[3] + ' ' + py + 'H' + (W - m[1]) + '" stroke="#8884"/><text x="' + (m[3] - 6) + '" y="' + (py + 4) + '" text-anchor="end" font-size="11" fill="currentColor">' + show(whole(v, dy)) + '</text>';
  }
  for (let v = Math.ceil(x0 / dx - 1e-9) * dx; v < x1 + 1e-9 * dx; v += dx) {
    out += '<text x="' + X(v) + '" y="' + (H - m[2] + 16) + '" text-anchor="middle" font-size="11" fill="currentColor">' + show(whole(v, dx)) + '</text>';
  }
  series.forEach((s, i) => {
    if (s.p.length > 1) out += '<path fill="none" stroke="' + hue[i % hue.length] + '" stroke-width="1.6" d="M' + s.p.map(p => X(p[0]).toFixed(1) + " " + Y(p[1]).toFixed(1)).join("L") + '"/>';
  });
  el.innerHTML = out + '<text x="' + W / 2 + '" y="' + (H - 6) + '" text-anchor="middle" font-size="12" fill="currentColor">' + xl + '</text><text transform="translate(13 ' + H / 2 + ') rotate(-90)" text-anchor="middle" font-size="12" fill="currentColor">' + yl + '</text></svg>';
}
const H = D.history, column = k => H.map(r => [r[0], r[k]]);
if (H.length > 1) {
  const path = axis => D.points.map(p => ({ n: p.n, p: H.map(r => [r[0], r[10 + 2 * p.k + axis]]) }));
  chart("ux", path(0), D.way, "x displacement (m)");
  chart("uy", path(1), D.way, "y displacement (m)");
  chart("energy", ["kinetic", "elastic", "gravity", "work of loads", "friction", "lost otherwise"].map((n, k) => ({ n: n, p: column(k + 1) })), D.way, "energy (J/m)");
  chart("steps", [{ n: "", p: column(7) }], D.way, "step (s)");
  chart("iterations", [{ n: "", p: column(8) }], D.way, "iterations in a step");
  chart("contacts", [{ n: "", p: column(9) }], D.way, "contacts that carry");
}
draw();
