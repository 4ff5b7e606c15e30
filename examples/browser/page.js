// The page: sliders, a picture of the blocks, and what the cutter says of them.

const roles = { joint: 0, fixed: 1, free: 2 };
const colours = { falling: 0xc0392b, lifting: 0x8e44ad, sliding: 0xe67e22, wedge: 0xf1c40f, rest: 0x9aa7b3 };
const scene = structuredClone(first);
const form = document.getElementById('form'), view = document.getElementById('view'), said = document.getElementById('said');

function slider(parent, text, unit, holder, name, min, max, step) {
  const label = document.createElement('label'), value = document.createElement('output'), input = document.createElement('input');
  Object.assign(input, { type: 'range', min: min, max: max, step: step, value: holder[name] });
  const show = function () { value.textContent = holder[name] + (unit ? ' ' + unit : ''); };
  input.addEventListener('input', function () {
    holder[name] = Number(input.value);
    show();
    later();
  });
  label.append(text, value, input);
  show();
  parent.append(label);
}

function group(title) {
  const set = document.createElement('fieldset'), legend = document.createElement('legend');
  legend.textContent = title;
  set.append(legend);
  form.append(set);
  return set;
}

scene.sets.forEach(function (set, s) {
  const box = group('Joint set ' + (s + 1));
  slider(box, 'Dip', '°', set, 'dip', 0, 90, 1);
  slider(box, 'Dip direction', '°', set, 'dip_direction', 0, 359, 1);
  slider(box, 'Fisher kappa', '', set, 'kappa', 5, 500, 5);
  slider(box, 'Intensity P32', 'm²/m³', set, 'p32', 0, 1.5, 0.05);
  slider(box, 'Mean diameter', 'm', set, 'diameter', 2, 40, 1);
  slider(box, 'Friction', '°', set, 'friction', 0, 60, 1);
});
const rock = group('Tunnel and rock');
slider(rock, 'Width', 'm', scene, 'width', 2, 14, 0.5);
slider(rock, 'Height', 'm', scene, 'height', 2, 14, 0.5);
slider(rock, 'Side of the cube', 'm', scene, 'side', 16, 40, 1);
slider(rock, 'Seed', '', scene, 'seed', 1, 200, 1);
const look = { apart: 0 };
const picture = group('Picture');
slider(picture, 'Blocks drawn apart', '%', look, 'apart', 0, 60, 5);

// ---- the picture ----------------------------------------------------------------------------------------------------
const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
view.prepend(renderer.domElement);
renderer.domElement.setAttribute('role', 'img');
renderer.domElement.setAttribute('aria-label', 'Blocks in 3D: key blocks in colour, tunnel walls in grey. Drag to orbit.');
const world = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(35, 1, 0.1, 1000);
camera.up.set(0, 0, 1);
camera.position.set(26, -46, 16);
world.add(new THREE.HemisphereLight(0xffffff, 0x9aa0a8, 0.9));
const lamp = new THREE.DirectionalLight(0xffffff, 0.4);
camera.add(lamp);
world.add(camera);
const controls = new THREE.OrbitControls(camera, renderer.domElement);
const draw = function () { renderer.render(world, camera); };
controls.addEventListener('change', draw);
new ResizeObserver(function () {
  renderer.setSize(view.clientWidth, view.clientHeight);
  camera.aspect = view.clientWidth / Math.max(view.clientHeight, 1);
  camera.updateProjectionMatrix();
  draw();
}).observe(view);

// Corners of a face's loops in its own plane, for the triangulation.
function trianglesOf(loops, points) {
  const n = new THREE.Vector3();
  loops[0].forEach(function (a, i) {  // Newell
    const b = loops[0][(i + 1) % loops[0].length], p = points[a], q = points[b];
    n.x += (p.y - q.y) * (p.z + q.z);
    n.y += (p.z - q.z) * (p.x + q.x);
    n.z += (p.x - q.x) * (p.y + q.y);
  });
  n.normalize();
  const u = new THREE.Vector3(Math.abs(n.x) < 0.6 ? 1 : 0, Math.abs(n.x) < 0.6 ? 0 : 1, 0).cross(n).normalize();
  const v = n.clone().cross(u);
  const flat = loops.map(function (loop) {
    return loop.map(function (c) { return new THREE.Vector2(points[c].dot(u), points[c].dot(v)); });
  });
  const all = loops.flat();
  return THREE.ShapeUtils.triangulateShape(flat[0], flat.slice(1)).map(function (t) { return t.map(function (i) { return all[i]; }); });
}

let drawn = null;
function show(result) {
  const points = [];
  for (let i = 0; i < result.points.length; i += 3) {
    points.push(new THREE.Vector3(result.points[i], result.points[i + 1], result.points[i + 2]));
  }
  const isKey = function (b) { return result.key[b] === 1 && result.batch[b] > 0; };
  const positions = [], tints = [], outlines = [];
  const colour = new THREE.Color();
  const middles = result.middles || (result.middles = middlesOf(result, points));
  const put = function (list, c, b) {
    const p = points[c], m = middles[b], away = look.apart / 100;
    list.push(p.x + away * m.x, p.y + away * m.y, p.z + away * m.z);
  };
  for (let f = 0; f < result.faceBlock.length; ++f) {
    const b = result.faceBlock[f];
    if (!isKey(b) && result.faceRole[f] !== roles.free) continue;  // the rock behind the walls is not drawn
    const loops = [];
    for (let l = result.faceLoopBegin[f]; l < result.faceLoopBegin[f + 1]; ++l) {
      loops.push(Array.from(result.corners.subarray(result.loopBegin[l], result.loopBegin[l + 1])));
    }
    colour.setHex(isKey(b) ? colours[modes[result.mode[b]]] || colours.rest : colours.rest);
    for (const triangle of trianglesOf(loops, points)) {
      for (const c of triangle) {
        put(positions, c, b);
        tints.push(colour.r, colour.g, colour.b);
      }
    }
    for (const loop of loops) {
      loop.forEach(function (c, i) {
        put(outlines, c, b);
        put(outlines, loop[(i + 1) % loop.length], b);
      });
    }
  }
  if (drawn) world.remove(drawn);
  drawn = new THREE.Group();
  const mesh = new THREE.BufferGeometry();
  mesh.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  mesh.setAttribute('color', new THREE.Float32BufferAttribute(tints, 3));
  mesh.computeVertexNormals();
  drawn.add(new THREE.Mesh(mesh, new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors || true, side: THREE.DoubleSide,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 })));
  const lines = new THREE.BufferGeometry();
  lines.setAttribute('position', new THREE.Float32BufferAttribute(outlines, 3));
  drawn.add(new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color: 0x333a40 })));
  world.add(drawn);
  draw();
}

function middlesOf(result, points) {
  const sum = Array.from(result.volume, function () { return new THREE.Vector3(); }), count = result.volume.map(function () { return 0; });
  for (let f = 0; f < result.faceBlock.length; ++f) {
    const b = result.faceBlock[f];
    for (let c = result.loopBegin[result.faceLoopBegin[f]]; c < result.loopBegin[result.faceLoopBegin[f + 1]]; ++c) {
      sum[b].add(points[result.corners[c]]);
      count[b] += 1;
    }
  }
  return sum.map(function (s, b) { return s.divideScalar(Math.max(count[b], 1)); });
}

// ---- what is said ---------------------------------------------------------------------------------------------------
function report(result, seconds) {
  const by = {};
  let count = 0, volume = 0, largest = 0;
  for (let b = 0; b < result.volume.length; ++b) {
    if (result.key[b] !== 1 || result.batch[b] === 0) continue;
    const mode = modes[result.mode[b]];
    by[mode] = (by[mode] || 0) + 1;
    count += 1;
    volume += result.volume[b];
    largest = Math.max(largest, result.volume[b]);
  }
  const rows = [['Blocks', result.volume.length], ['Key blocks', count], ['Their volume', volume.toFixed(2) + ' m³'],
    ['Largest', largest.toFixed(2) + ' m³']];
  const table = document.createElement('table');
  for (const [name, value] of rows) {
    const row = table.insertRow();
    row.insertCell().textContent = name;
    row.insertCell().textContent = value;
  }
  for (const mode of Object.keys(by)) {
    const row = table.insertRow(), cell = row.insertCell(), dot = document.createElement('span');
    dot.className = 'dot';
    dot.style.background = '#' + colours[mode].toString(16).padStart(6, '0');
    cell.append(dot, mode);
    row.insertCell().textContent = by[mode];
  }
  const time = document.createElement('small');
  time.textContent = 'Cut, certified and judged in ' + seconds.toFixed(2) + ' s. Blocks one by one; rigid, without stress.';
  said.replaceChildren(table, time);
}

const cleave = await load(Uint8Array.from(atob(wasm), function (c) { return c.charCodeAt(0); }));
let waiting = 0, last = null, cutFor = '';
function later() {
  clearTimeout(waiting);
  waiting = setTimeout(renew, 120);
}
function renew() {
  const now = JSON.stringify(scene);
  if (last && now === cutFor) return show(last);
  const started = performance.now();
  try {
    last = cleave.cut(scene);
    cutFor = now;
  } catch (error) {
    said.replaceChildren(Object.assign(document.createElement('span'), { className: 'wrong', textContent: error.message }));
    return undefined;
  }
  report(last, (performance.now() - started) / 1000);
  return show(last);
}
renew();
