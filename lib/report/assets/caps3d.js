// Where the plane of the cut crosses blocks: their section as triangles, and its outline. Corners on the plane count as
// beyond it, so that every surface is crossed along closed lines.
// `axis` 0, 1 or 2 and `at` say the plane; blocks for which `wanted` is false are left out; each is moved by `offsetOf`.
// Returns { position, block, edges }: nine numbers a triangle, its block, six numbers a line.
const caps3d = function (axis, at, wanted, offsetOf) {
  'use strict';
  const { triangles, points, firstFace, firstTriangle, blocks } = blocks3d;
  const u = (axis + 1) % 3, v = (axis + 2) % 3;
  const out = { position: [], block: [], edges: [] };

  // Lines through the triangles of a block, from the edge where its surface goes beyond the plane to where it comes back.
  const crossings = function (b, move) {
    const height = function (i) { return points[3 * i + axis] + move[axis] - at; };
    const crossing = function (i, j) {
      const a = height(i), s = a / (a - height(j));
      return [points[3 * i + u] + s * (points[3 * j + u] - points[3 * i + u]) + move[u], points[3 * i + v] + s * (points[3 * j + v] - points[3 * i + v]) + move[v]];
    };
    const next = new Map();
    for (let t = firstTriangle[firstFace[b]]; t < firstTriangle[firstFace[b + 1]]; ++t) {
      const beyond = [0, 1, 2].map(function (k) { return height(triangles[3 * t + k]) >= 0; });
      if (beyond[0] === beyond[1] && beyond[1] === beyond[2]) continue;
      const line = {};
      for (let k = 0; k < 3; ++k) {
        const m = (k + 1) % 3;
        if (beyond[k] === beyond[m]) continue;
        const i = triangles[3 * t + k], j = triangles[3 * t + m];
        // One way round for both triangles of an edge, so that they meet at one point.
        const key = Math.min(i, j) * 4294967296 + Math.max(i, j);
        if (beyond[m]) { line.from = key; line.start = crossing(Math.min(i, j), Math.max(i, j)); } else line.to = key;
      }
      if (!next.has(line.from)) next.set(line.from, []);
      next.get(line.from).push(line);
    }
    return next;
  };
  const loopsOf = function (next) {
    const loops = [];
    next.forEach(function (lines) {
      while (lines.length > 0) {
        const loop = [];
        for (let line = lines.pop(); line; line = (next.get(line.to) || []).pop()) loop.push(new THREE.Vector2(line.start[0], line.start[1]));
        if (loop.length > 2) loops.push(loop);
      }
    });
    return loops;
  };
  const inside = function (p, loop) {
    let odd = false;
    for (let i = 0, j = loop.length - 1; i < loop.length; j = i++) {
      if ((loop[i].y > p.y) !== (loop[j].y > p.y) && p.x < (loop[j].x - loop[i].x) * (p.y - loop[i].y) / (loop[j].y - loop[i].y) + loop[i].x) odd = !odd;
    }
    return odd;
  };
  const put = function (list, p) {
    const at3 = [0, 0, 0];
    at3[axis] = at; at3[u] = p.x; at3[v] = p.y;
    list.push(at3[0], at3[1], at3[2]);
  };

  for (let b = 0; b < blocks; ++b) {
    if (!wanted(b)) continue;
    const loops = loopsOf(crossings(b, offsetOf(b)));
    if (loops.length === 0) continue;
    loops.forEach(function (loop) {
      loop.forEach(function (p, k) { put(out.edges, p); put(out.edges, loop[(k + 1) % loop.length]); });
    });
    // Within an odd number of others: a hole, of the smallest of those.
    const size = loops.map(function (loop) { return Math.abs(THREE.ShapeUtils.area(loop)); });
    const around = loops.map(function (loop, i) { return loops.map(function (o, k) { return k; }).filter(function (k) { return k !== i && size[k] > size[i] && inside(loop[0], loops[k]); }); });
    loops.forEach(function (outline, i) {
      if (around[i].length % 2 === 1) return;
      const holes = loops.filter(function (o, k) {
        return around[k].length === around[i].length + 1 && around[k].indexOf(i) >= 0;
      });
      const corners = [].concat.apply(outline, holes);
      THREE.ShapeUtils.triangulateShape(outline, holes).forEach(function (t) {
        t.forEach(function (k) { put(out.position, corners[k]); });
        out.block.push(b);
      });
    });
  }
  return out;
};
