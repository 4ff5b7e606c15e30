"use strict";
// Numbers as the pages of scenes in two dimensions write them.
const plain = v => v === 0 ? "0" : Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3 ? (+v.toPrecision(3)).toExponential() : String(+v.toPrecision(4));
const show = v => plain(v).replace(/-/g, "\u2212");

// A plot of `series` ({ n: name, p: points }) as SVG in the element `id`. `from`: the x axis begins there or before. `least`: the
// y axis spans no less, so that rounding does not look like motion. `zero`: it begins at 0; `count`: in whole numbers. `log`: both
// axes are logarithmic, points have dots.
const chart2d = function (id, series, xl, yl, { from = Infinity, least = 0, zero = false, count = false, log = false } = {}) {
  const el = document.getElementById(id);
  if (!el || !series.some(s => s.p.length)) return;
  const W = Math.max(340, Math.min(640, el.clientWidth || 640)), H = 280, m = [14, 14, 40, 78], hue = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#666666"];
  const text = s => s.replace(/&/g, "&amp;").replace(/</g, "&lt;");
  const scaled = v => log ? Math.log10(Math.max(v, 1e-300)) : v;
  let x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  for (const s of series) for (const p of s.p) { x0 = Math.min(x0, scaled(p[0])); x1 = Math.max(x1, scaled(p[0])); y0 = Math.min(y0, scaled(p[1])); y1 = Math.max(y1, scaled(p[1])); }
  if (!(x1 > x0)) { x0 -= .5; x1 += .5; }
  x0 = Math.min(x0, from);
  if (zero) y0 = 0;
  if (count) y1 = Math.max(y1, 1);
  if (!(y1 > y0)) { const d = Math.abs(y0) || 1; y0 -= d / 2; y1 += d / 2; }
  if (y1 - y0 < least) { const middle = Math.abs(y0) < least && Math.abs(y1) < least ? 0 : (y0 + y1) / 2; y0 = middle - least / 2; y1 = middle + least / 2; }
  // Ticks at 1, 2 or 5 times a power of ten; the y axis ends at one.
  const between = (a, b) => { const p = Math.pow(10, Math.floor(Math.log10((b - a) / 4))), s = (b - a) / 4 / p; return p * (s <= 1 ? 1 : s <= 2 ? 2 : s <= 5 ? 5 : 10); };
  const dx = between(x0, x1), dy = count ? Math.max(1, between(y0, y1)) : between(y0, y1);
  const label = (v, d) => { const whole = Math.round(v / d) * d; return show(log ? Math.pow(10, whole) : whole); };
  y0 = Math.floor(y0 / dy + 1e-9) * dy; y1 = Math.ceil(y1 / dy - 1e-9) * dy;
  // Names stand above the plot, in as many lines as they need.
  let names = "", at = m[3], line = 0;
  series.forEach((s, i) => {
    if (!s.n) return;
    const wide = 34 + 6.6 * s.n.length;
    if (at > m[3] && at + wide > W - m[1]) { at = m[3]; ++line; }
    const c = hue[i % hue.length], y = 13 + 15 * line;
    names += '<path d="M' + at + ' ' + (y - 4) + 'h16" stroke="' + c + '" stroke-width="2"/><text x="' + (at + 20) + '" y="' + y + '" font-size="12" fill="currentColor">' + text(s.n) + '</text>';
    at += wide;
  });
  if (names) m[0] += 8 + 15 * line;
  const X = v => m[3] + (v - x0) / (x1 - x0) * (W - m[1] - m[3]), Y = v => H - m[2] - (v - y0) / (y1 - y0) * (H - m[0] - m[2]);
  let out = '<svg viewBox="0 0 ' + W + ' ' + H + '" role="img" aria-label="' + yl + ' against ' + xl + '" style="max-width:100%">' + names;
  for (let v = y0; v < y1 + dy / 2; v += dy) {
    const py = Y(v);
    out += '<path d="M' + m[3] + ' ' + py + 'H' + (W - m[1]) + '" stroke="#8884"/><text x="' + (m[3] - 6) + '" y="' + (py + 4) + '" text-anchor="end" font-size="11" fill="currentColor">' + label(v, dy) + '</text>';
  }
  for (let v = Math.ceil(x0 / dx - 1e-9) * dx; v < x1 + 1e-9 * dx; v += dx) {
    out += '<text x="' + X(v) + '" y="' + (H - m[2] + 16) + '" text-anchor="middle" font-size="11" fill="currentColor">' + label(v, dx) + '</text>';
  }
  series.forEach((s, i) => {
    const c = hue[i % hue.length], at = s.p.map(p => [X(scaled(p[0])).toFixed(1), Y(scaled(p[1])).toFixed(1)]);
    if (at.length > 1) out += '<path fill="none" stroke="' + c + '" stroke-width="1.6" d="M' + at.map(p => p.join(" ")).join("L") + '"/>';
    if (log) for (const p of at) out += '<circle r="4" fill="' + c + '" cx="' + p[0] + '" cy="' + p[1] + '"/>';
  });
  el.innerHTML = out + '<text x="' + W / 2 + '" y="' + (H - 6) + '" text-anchor="middle" font-size="12" fill="currentColor">' + xl + '</text><text transform="translate(13 ' + H / 2 + ') rotate(-90)" text-anchor="middle" font-size="12" fill="currentColor">' + yl + '</text></svg>';
};
