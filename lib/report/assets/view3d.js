// The blocks in 3D, where WebGL is there: drawn in layers, cut, moved and coloured. What is shown
// is in `state`; after a change to it `rebuild` (what is drawn) or `restyle` (how) is to be called. Null without WebGL.
const view3d = (function () {
  'use strict';
  const holder = document.getElementById('scene');
  if (!holder || !blocks3d || typeof THREE === 'undefined') return null;
  const probe = document.createElement('canvas');
  let context = null;
  try { context = probe.getContext('webgl') || probe.getContext('experimental-webgl'); } catch (e) { context = null; }
  if (!context) return null;  // the still picture and a sentence stay
  const {
    data, bytes, triangles, faceBlock, faceRole, faceTriangles, blockId, batch, mode,
    factor, volume, faceCount, blocks, points, extent, indexOf, firstFace, firstTriangle,
    centre, judged, walls, isWall, batchColourOf, modeColours, factorSteps, volumeSteps, css,
    state, shown, colourOf, faceColourOf, setNames, usedSets, setColour, groups
  } = blocks3d;

  // ---- the scene --------------------------------------------------------------------------------------------------
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
  } catch (e) {
    return null;
  }
  holder.classList.add('live');
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  renderer.localClippingEnabled = true;
  renderer.domElement.tabIndex = 0;
  renderer.domElement.setAttribute('role', 'img');
  renderer.domElement.setAttribute('aria-label', 'Blocks in 3D. Keys: arrows turn, + and - zoom, N and P next and previous key block, ' +
    'F goes to the picked block, I shows it alone, Escape lets it go, Home is the start view. The table of key blocks holds the same facts.');
  holder.prepend(renderer.domElement);
  const printed = document.createElement('img');
  printed.id = 'printed';
  printed.alt = 'The 3D view as it was when printed';
  holder.append(printed);

  const scene = new THREE.Scene();
  scene.add(new THREE.HemisphereLight(0xffffff, 0xaab0b8, 0.8));
  const section = new THREE.Plane(new THREE.Vector3(0, -1, 0), extent);
  const lambert = function (options) {
    return new THREE.MeshLambertMaterial(Object.assign({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide, polygonOffset: true,
      polygonOffsetFactor: 1, polygonOffsetUnits: 1 }, options));
  };
  const layers = {
    key: new THREE.Mesh(new THREE.BufferGeometry(), lambert({})),
    wall: new THREE.Mesh(new THREE.BufferGeometry(), lambert({ clippingPlanes: [section] })),
    rest: new THREE.Mesh(new THREE.BufferGeometry(), lambert({ clippingPlanes: [section] })),
    caps: new THREE.Mesh(new THREE.BufferGeometry(), lambert({}))
  };
  const lines = {
    key: new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x16191c })),
    wall: new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.55, clippingPlanes: [section] })),
    rest: new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.3, clippingPlanes: [section] })),
    caps: new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x16191c })),
    picked: new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0xffffff, depthTest: false })),
    arrows: new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0xc0392b, depthTest: false }))
  };
  layers.wall.renderOrder = 1; layers.rest.renderOrder = 3; lines.picked.renderOrder = lines.arrows.renderOrder = 9;
  Object.values(layers).concat(Object.values(lines)).forEach(function (o) { o.frustumCulled = false; scene.add(o); });
  // ---- bolts ------------------------------------------------------------------------------------------------------
  const boltNames = ['hold', 'pull at groups of blocks', 'redundant', 'too short', 'in compression', 'serve no block', 'off the rock'];
  const boltColours = ['#009E73', '#0072B2', '#56B4E9', '#D55E00', '#CC79A7', '#9aa1a8', '#B8A800'];
  const bolts = data.bolts ? new Float32Array(bytes(data.bolts)) : null;
  const boltStatus = bolts ? new Uint8Array(bytes(data.boltStatus)) : null;
  const boltServes = bolts ? new Uint32Array(bytes(data.boltServes)) : null;
  const boltLayers = [];
  if (bolts) {
    boltNames.forEach(function (name, s) {
      const list = [];
      for (let i = 0; i < boltStatus.length; ++i) if (boltStatus[i] === s) for (let k = 0; k < 6; ++k) list.push(bolts[6 * i + k]);
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(list), 3));
      const layer = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: boltColours[s], linewidth: 2 }));
      layer.frustumCulled = false;
      layer.renderOrder = 8;
      layer.visible = list.length > 0;
      boltLayers.push({ name: name, colour: boltColours[s], count: list.length / 6, layer: layer });
      scene.add(layer);
    });
  }
  const frame = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(data.size[0], data.size[1], data.size[2])),
    new THREE.LineBasicMaterial({ transparent: true, opacity: 0.5 }));
  scene.add(frame);

  const faceEdges = function (f, use) {
    const from = firstTriangle[f], to = firstTriangle[f + 1];
    if (to - from > 12) {
      const seen = new Set();
      for (let t = from; t < to; ++t) for (let k = 0; k < 3; ++k) seen.add(triangles[3 * t + k] * 4294967296 + triangles[3 * t + (k + 1) % 3]);
      seen.forEach(function (e) {
        const a = Math.floor(e / 4294967296), b = e % 4294967296;
        if (!seen.has(b * 4294967296 + a)) use(a, b);
      });
      return;
    }
    for (let t = from; t < to; ++t) {
      for (let k = 0; k < 3; ++k) {
        const a = triangles[3 * t + k], b = triangles[3 * t + (k + 1) % 3];
        let inner = false;
        for (let u = from; u < to && !inner; ++u) {
          for (let m = 0; m < 3; ++m) if (triangles[3 * u + m] === b && triangles[3 * u + (m + 1) % 3] === a) inner = true;
        }
        if (!inner) use(a, b);
      }
    }
  };
  const offset = [0, 0, 0];
  const offsetOf = function (b) {
    for (let k = 0; k < 3; ++k) offset[k] = (centre[3 * b + k] - focus[k]) * state.explode;
    return offset;
  };

  // How far a corner of a block of the picked group has moved, to first order.
  const motionOf = function (b) {
    const m = state.group >= 0 && state.moved > 0 ? groups[state.group].get(b) : undefined;
    if (!m) return null;
    const s = state.moved * groupScale(state.group);
    return function (p, o) {
      const x = p[o] - m[0], y = p[o + 1] - m[1], z = p[o + 2] - m[2];
      p[o] += s * (m[3] + m[7] * z - m[8] * y);
      p[o + 1] += s * (m[4] + m[8] * x - m[6] * z);
      p[o + 2] += s * (m[5] + m[6] * y - m[7] * x);
    };
  };
  // The corner that moves fastest goes a third of the way across the group.
  const groupScale = function (g) {
    let fastest = 0;
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    groups[g].forEach(function (m, b) {
      for (let i = 3 * firstTriangle[firstFace[b]]; i < 3 * firstTriangle[firstFace[b + 1]]; ++i) {
        const p = [0, 1, 2].map(function (k) { return points[3 * triangles[i] + k]; });
        const x = p[0] - m[0], y = p[1] - m[1], z = p[2] - m[2];
        fastest = Math.max(fastest, Math.hypot(m[3] + m[7] * z - m[8] * y, m[4] + m[8] * x - m[6] * z, m[5] + m[6] * y - m[7] * x));
        for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], p[k]); high[k] = Math.max(high[k], p[k]); }
      }
    });
    return fastest > 0 ? Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) / 3 / fastest : 0;
  };
  // An arrow from the centroid of each block of the group, as long as it moves, with a head.
  const drawArrows = function () {
    const list = [];
    if (state.group >= 0) {
      const scale = groupScale(state.group);
      groups[state.group].forEach(function (m) {
        const v = [scale * m[3], scale * m[4], scale * m[5]], length = Math.hypot(v[0], v[1], v[2]);
        if (!(length > extent / 2000)) return;
        const tip = [m[0] + v[0], m[1] + v[1], m[2] + v[2]];
        list.push(m[0], m[1], m[2], tip[0], tip[1], tip[2]);
        const aside = new THREE.Vector3(v[0], v[1], v[2]).cross(new THREE.Vector3(v[2], v[0], v[1])).setLength(length / 10);
        [1, -1].forEach(function (s) {
          list.push(tip[0], tip[1], tip[2], tip[0] - 0.2 * v[0] + s * aside.x, tip[1] - 0.2 * v[1] + s * aside.y, tip[2] - 0.2 * v[2] + s * aside.z);
        });
      });
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(list), 3));
    lines.arrows.geometry.dispose();
    lines.arrows.geometry = geometry;
    lines.arrows.visible = list.length > 0;
  };

  // What is looked at: the excavation and the key blocks, else everything.
  const focus = [0, 0, 0];
  let reach = extent / 2;
  (function () {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let f = 0; f < faceBlock.length; ++f) {
      if (!(faceRole[f] === 3 || batch[faceBlock[f]] > 0)) continue;
      for (let i = 3 * firstTriangle[f]; i < 3 * firstTriangle[f + 1]; ++i) {
        for (let k = 0; k < 3; ++k) {
          const v = points[3 * triangles[i] + k];
          low[k] = Math.min(low[k], v); high[k] = Math.max(high[k], v);
        }
      }
    }
    if (low[0] > high[0]) return;
    let sum = 0;
    for (let k = 0; k < 3; ++k) { focus[k] = (low[k] + high[k]) / 2; sum += (high[k] - low[k]) * (high[k] - low[k]); }
    reach = Math.max(Math.sqrt(sum) / 2, extent / 50);
  })();

  const eye = camera3d(holder, renderer, scene, state, {
    extent: extent, focus: focus, reach: Math.max(reach, judged || walls ? 0 : extent / 2), offsetOf: offsetOf
  });
  const render = eye.render;

  const restFace = function (f) {
    if (state.explode > 0 || state.cut < 1) return true;
    return faceRole[f] !== 0;
  };
  // The layer of a face, or null.
  const layerOf = function (f) {
    const b = faceBlock[f];
    if (shown(b)) return 'key';
    if ((state.only >= 0 || state.group >= 0) && state.restOpacity === 0) return null;
    if (isWall(faceRole[f])) return state.wallOpacity > 0 ? 'wall' : null;
    return state.restOpacity > 0 && restFace(f) ? 'rest' : null;
  };

  const blockOfTriangle = {};
  // Neighbouring blocks of the rest differ a little, so that they can be told apart.
  const toneOf = function (b) { return 0.9 + 0.1 * ((blockId[b] * 2654435761 >>> 8) % 97) / 97; };
  // Blocks of the rest on the plane of the cut, as a section through rock shows them: opaque, each with its outline.
  const drawCaps = function () {
    const k = { x: 0, y: 1, z: 2 }[state.axis];
    const on = state.cut < 1 && state.restOpacity > 0;
    const found = on ? caps3d(k, -section.normal.getComponent(k) * section.constant, function (b) { return !shown(b); }, offsetOf) : { position: [], block: [], edges: [] };
    const rock = new THREE.Color(css('--wall')), colour = new THREE.Color(), colours = new Uint8Array(found.position.length);
    found.block.forEach(function (b, t) {
      const plain = !(state.colourBy === 'volume');
      if (plain) colour.copy(rock); else colour.set(colourOf(b));
      const tone = plain ? toneOf(b) : 1;
      for (let c = 0; c < 3; ++c) colours.set([255 * colour.r * tone, 255 * colour.g * tone, 255 * colour.b * tone].map(Math.round), 9 * t + 3 * c);
    });
    const normals = new Float32Array(found.position.length);
    for (let i = k; i < normals.length; i += 3) normals[i] = -section.normal.getComponent(k);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(found.position), 3));
    geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3, true));
    layers.caps.geometry.dispose();
    layers.caps.geometry = geometry;
    layers.caps.visible = found.block.length > 0;
    const outlines = new THREE.BufferGeometry();
    outlines.setAttribute('position', new THREE.BufferAttribute(new Float32Array(found.edges), 3));
    lines.caps.geometry.dispose();
    lines.caps.geometry = outlines;
    lines.caps.visible = found.edges.length > 0;
    lines.caps.material.color.set(css('--edge'));
    blockOfTriangle.caps = found.block;
  };

  const rebuild = function () {
    const counts = { key: 0, wall: 0, rest: 0 };
    const place = new Array(faceBlock.length);
    for (let f = 0; f < faceBlock.length; ++f) {
      place[f] = layerOf(f);
      if (place[f]) counts[place[f]] += faceTriangles[f];
    }
    const wallColour = new THREE.Color(css('--wall')), restColour = new THREE.Color(css('--wall'));
    const fill = {}, edges = { key: [], wall: [], rest: [] };
    Object.keys(counts).forEach(function (name) {
      fill[name] = { at: 0, position: new Float32Array(9 * counts[name]), normal: new Float32Array(9 * counts[name]), colour: new Uint8Array(9 * counts[name]) };
      blockOfTriangle[name] = new Uint32Array(counts[name]);
    });
    const colour = new THREE.Color();
    const drawRestEdges = state.restOpacity >= 0.2, coloured = state.colourBy === 'set' || (!judged && state.colourBy === 'volume');
    for (let f = 0; f < faceBlock.length; ++f) {
      const name = place[f];
      if (!name) continue;
      const to = fill[name], b = faceBlock[f], move = offsetOf(b), go = motionOf(b);
      const plain = name !== 'key' && !(coloured && name === 'rest');
      if (plain) colour.copy(name === 'wall' ? wallColour : restColour); else colour.set(faceColourOf(f));
      const tone = plain ? toneOf(b) : 1;
      const r = Math.round(255 * colour.r * tone), g = Math.round(255 * colour.g * tone), bl = Math.round(255 * colour.b * tone);
      for (let t = firstTriangle[f]; t < firstTriangle[f + 1]; ++t) {
        const p = to.position, n = to.normal, o = 9 * to.at;
        for (let k = 0; k < 3; ++k) {
          const v = 3 * triangles[3 * t + k];
          for (let c = 0; c < 3; ++c) p[o + 3 * k + c] = points[v + c] + move[c];
          if (go) go(p, o + 3 * k);
          to.colour[o + 3 * k] = r; to.colour[o + 3 * k + 1] = g; to.colour[o + 3 * k + 2] = bl;
        }
        const ux = p[o + 3] - p[o], uy = p[o + 4] - p[o + 1], uz = p[o + 5] - p[o + 2];
        const vx = p[o + 6] - p[o], vy = p[o + 7] - p[o + 1], vz = p[o + 8] - p[o + 2];
        let x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
        const l = Math.hypot(x, y, z) || 1;
        x /= l; y /= l; z /= l;
        for (let k = 0; k < 3; ++k) { n[o + 3 * k] = x; n[o + 3 * k + 1] = y; n[o + 3 * k + 2] = z; }
        blockOfTriangle[name][to.at++] = b;
      }
      if (name !== 'rest' || drawRestEdges) {
        const list = edges[name];
        faceEdges(f, function (i, j) {
          list.push(points[3 * i] + move[0], points[3 * i + 1] + move[1], points[3 * i + 2] + move[2],
            points[3 * j] + move[0], points[3 * j + 1] + move[1], points[3 * j + 2] + move[2]);
          if (go) { go(list, list.length - 6); go(list, list.length - 3); }
        });
      }
    }
    Object.keys(counts).forEach(function (name) {
      const geometry = new THREE.BufferGeometry(), f = fill[name];
      geometry.setAttribute('position', new THREE.BufferAttribute(f.position, 3));
      geometry.setAttribute('normal', new THREE.BufferAttribute(f.normal, 3));
      geometry.setAttribute('color', new THREE.BufferAttribute(f.colour, 3, true));
      layers[name].geometry.dispose();
      layers[name].geometry = geometry;
      layers[name].visible = counts[name] > 0;
      const wires = new THREE.BufferGeometry();
      wires.setAttribute('position', new THREE.BufferAttribute(new Float32Array(edges[name]), 3));
      lines[name].geometry.dispose();
      lines[name].geometry = wires;
      lines[name].visible = edges[name].length > 0;
    });
    const edgeColour = new THREE.Color(css('--edge'));
    lines.wall.material.color.copy(edgeColour);
    lines.rest.material.color.copy(edgeColour);
    frame.material.color.copy(edgeColour);
    style();
    drawPicked();
    drawArrows();
    render();
  };

  const style = function () {
    [['wall', state.wallOpacity], ['rest', state.restOpacity]].forEach(function (pair) {
      const material = layers[pair[0]].material;
      material.opacity = pair[1];
      material.transparent = pair[1] < 1;
      material.depthWrite = pair[1] >= 1;
      material.needsUpdate = true;
    });
    lines.rest.material.opacity = 0.6 * state.restOpacity;
    lines.wall.material.opacity = 0.15 + 0.45 * state.wallOpacity;
    const k = { x: 0, y: 1, z: 2 }[state.axis], half = data.size[k] / 2 * (1 + state.explode);
    // From the side of the start view: south, east, above.
    section.normal.set(k === 0 ? -1 : 0, k === 1 ? 1 : 0, k === 2 ? -1 : 0);
    section.constant = state.cut >= 1 ? 100 * extent : half * (2 * state.cut - 1);
    drawCaps();
    frame.visible = state.explode === 0;
    boltLayers.forEach(function (b) { b.layer.visible = b.count > 0 && b.on !== false && state.explode === 0; });
  };

  const drawPicked = function () {
    const list = [];
    if (state.picked >= 0) {
      const move = offsetOf(state.picked);
      for (let f = firstFace[state.picked]; f < firstFace[state.picked + 1]; ++f) {
        faceEdges(f, function (i, j) {
          list.push(points[3 * i] + move[0], points[3 * i + 1] + move[1], points[3 * i + 2] + move[2],
            points[3 * j] + move[0], points[3 * j + 1] + move[1], points[3 * j + 2] + move[2]);
        });
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(list), 3));
    lines.picked.geometry.dispose();
    lines.picked.geometry = geometry;
    lines.picked.visible = list.length > 0;
    lines.picked.material.color.set(css('--ink'));
  };

  // From which of them the pointer picks: what is nearly clear, or cut away, is picked through.
  const pickable = [['key', 0], ['caps', 0.01], ['wall', 0.3], ['rest', 0.3]].map(function (pair) {
    const [name, least] = pair, clipped = name === 'wall' || name === 'rest';
    return {
      layer: layers[name],
      least: least,
      seen: function (point) { return !clipped || section.distanceToPoint(point) >= 0; },
      blockOf: function (triangle) { return blockOfTriangle[name][triangle]; }
    };
  });
  const servingBolts = function (b) {
    let serving = 0;
    for (let i = 0; i < boltServes.length; ++i) if (boltServes[i] === blockId[b]) ++serving;
    return serving;
  };

  // ---- life -------------------------------------------------------------------------------------------------------
  window.addEventListener('beforeprint', function () {
    printed.src = eye.picture();
  });
  renderer.domElement.addEventListener('webglcontextlost', function (e) { e.preventDefault(); holder.classList.remove('live'); });
  renderer.domElement.addEventListener('webglcontextrestored', function () { holder.classList.add('live'); rebuild(); });
  const dark = window.matchMedia ? window.matchMedia('(prefers-color-scheme: dark)') : null;
  if (dark && dark.addEventListener) dark.addEventListener('change', rebuild);

  return {
    state: state, rebuild: rebuild, section: section, caps: layers.caps,
    restyle: function () { style(); render(); },
    start: function () { eye.resize(); eye.home(); rebuild(); },
    look: eye.look, home: eye.home, extent: extent, focus: focus, reach: reach,
    walls: faceRole.some(isWall), bolts: bolts ? boltLayers : null, servingBolts: servingBolts,
    blocks: { id: blockId, mode: mode, volume: volume, faces: faceCount }, indexOf: indexOf,
    batchColour: batchColourOf, modeColour: function (m) { return modeColours[m]; }, factorSteps: factorSteps, setNames: setNames, usedSets: usedSets, setColour: setColour,
    place: holder.parentNode, holder: holder, canvas: renderer.domElement, onPick: function (listener) { pick3d(renderer, eye.camera, pickable, listener); }, volumeSteps: volumeSteps,
    groups: groups, zoomTo: eye.zoomTo, turn: eye.turn, zoom: eye.zoom, parallel: eye.parallel, picture: eye.picture,
    mark: function (b) { state.picked = b; drawPicked(); render(); }
  };
})();
