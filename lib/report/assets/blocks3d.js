// The blocks of the page unpacked: corners, faces, figures and colours of each, and which of them are shown (`state`).
const blocks3d = (function () {
  'use strict';
  const source = document.getElementById('data');
  if (!source) return null;
  const data = JSON.parse(source.textContent);
  const bytes = function (text) {
    const raw = atob(text), out = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; ++i) out[i] = raw.charCodeAt(i);
    return out.buffer;
  };
  const packed = new Uint16Array(bytes(data.positions));
  const triangles = new Uint32Array(bytes(data.triangles));
  const faceBlock = new Uint32Array(bytes(data.faceBlock));
  const faceRole = new Uint8Array(bytes(data.faceRole));
  const faceTriangles = new Uint32Array(bytes(data.faceTriangles));
  const setNames = data.setNames || [];
  const faceSet = setNames.length > 0 ? new Uint16Array(bytes(data.faceSet)) : null;
  const usedSets = new Set(faceSet || []);
  const blockId = new Uint32Array(bytes(data.id));
  const batch = new Uint16Array(bytes(data.batch));
  const mode = new Uint8Array(bytes(data.mode));
  const factor = new Float32Array(bytes(data.factor));
  const volume = new Float32Array(bytes(data.volume));
  const faceCount = new Uint32Array(bytes(data.faces));
  const blocks = blockId.length;

  const points = new Float32Array(packed.length);
  for (let i = 0; i < packed.length; ++i) points[i] = (packed[i] / 65535 - 0.5) * data.size[i % 3];
  const extent = Math.hypot(data.size[0], data.size[1], data.size[2]) || 1;

  const indexOf = new Map();
  for (let b = 0; b < blocks; ++b) indexOf.set(blockId[b], b);
  const firstFace = new Uint32Array(blocks + 1), firstTriangle = new Uint32Array(faceBlock.length + 1);
  for (let f = 0; f < faceBlock.length; ++f) {
    firstTriangle[f + 1] = firstTriangle[f] + faceTriangles[f];
    firstFace[faceBlock[f] + 1] = f + 1;
  }
  for (let b = 1; b <= blocks; ++b) firstFace[b] = Math.max(firstFace[b], firstFace[b - 1]);
  const centre = new Float32Array(3 * blocks);
  for (let b = 0; b < blocks; ++b) {
    const from = 3 * firstTriangle[firstFace[b]], to = 3 * firstTriangle[firstFace[b + 1]];
    for (let k = 0; k < 3; ++k) {
      let sum = 0;
      for (let i = from; i < to; ++i) sum += points[3 * triangles[i] + k];
      centre[3 * b + k] = to > from ? sum / (to - from) : 0;
    }
  }
  // Key groups: the places of their blocks, and centroid, velocity and spin of each.
  const groups = [];
  if (data.groupSizes) {
    const of = new Uint32Array(bytes(data.groupBlocks)), motions = new Float32Array(bytes(data.groupMotions));
    let at = 0;
    new Uint32Array(bytes(data.groupSizes)).forEach(function (size) {
      const members = new Map();
      for (let k = at; k < at + size; ++k) if (indexOf.has(of[k])) members.set(indexOf.get(of[k]), motions.subarray(9 * k, 9 * k + 9));
      groups.push(members);
      at += size;
    });
  }
  const judged = batch.some(function (n) { return n > 0; });
  const walls = faceRole.some(function (r) { return r === 3; });
  const isWall = function (role) { return role === 3 || (role === 2 && judged); };

  // ---- colours ----------------------------------------------------------------------------------------------------
  const batchColours = ['#D55E00', '#E69F00', '#0072B2', '#56B4E9', '#009E73', '#CC79A7', '#B8A800', '#7A5195'];
  const laterColour = '#7d8590', staysColour = '#8fb3a8';
  const batchColourOf = function (n) { return n === 0 ? staysColour : n > 8 ? laterColour : batchColours[n - 1]; };
  const modeColours = ['#D55E00', '#CC79A7', '#0072B2', '#E69F00', '#8fb3a8', '#8fb3a8'];
  const factorSteps = [
    ['no strength: 0', '#7f2704', function (f) { return f <= 0; }],
    ['below 0.5', '#d94801', function (f) { return f < 0.5; }],
    ['0.5 to 1', '#fdae6b', function (f) { return f < 1; }],
    ['1 to 1.5', '#9ecae1', function (f) { return f < 1.5; }],
    ['1.5 and more', '#3182bd', function () { return true; }]];
  const volumeSteps = [['below 0.1 m\u00b3', '#440154', 0.1], ['0.1 to 1', '#3b528b', 1], ['1 to 10', '#21918c', 10],
    ['10 to 100', '#5ec962', 100], ['100 m\u00b3 and more', '#fde725', Infinity]];
  const setColour = function (s) { return batchColours[s % batchColours.length]; };
  const factorStep = function (f) { return factorSteps.findIndex(function (s) { return s[2](f); }); };
  const css = function (name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); };

  const movable = function (b) { return mode[b] < 4; };
  const state = {
    colourBy: 'batch', explode: 0, wallOpacity: 1, restOpacity: judged ? 0.05 : 1, axis: 'y', cut: 1, picked: -1, only: -1, group: -1, moved: 0, parallel: false,
    batches: new Map(), modes: new Map()
  };
  const batchKey = function (b) { return batch[b] > 8 ? 9 : batch[b]; };
  for (let b = 0; b < blocks; ++b) {
    if (!movable(b)) continue;
    const count = function (map, key, on) {
      const entry = map.get(key) || { n: 0, on: on };
      entry.n += 1;
      map.set(key, entry);
    };
    count(state.batches, batchKey(b), batch[b] > 0);
    count(state.modes, mode[b], true);
  }
  const shown = function (b) {
    if (state.only >= 0) return b === state.only;
    if (state.group >= 0) return groups[state.group].has(b);
    return movable(b) && state.batches.get(batchKey(b)).on && state.modes.get(mode[b]).on;
  };
  const colourOf = function (b) {
    if (state.colourBy === 'mode') return modeColours[mode[b]];
    if (state.colourBy === 'factor') return movable(b) ? factorSteps[factorStep(factor[b])][1] : staysColour;
    if (state.colourBy === 'volume') return volumeSteps.find(function (s) { return volume[b] < s[2]; })[1];
    return batchColourOf(batch[b]);
  };
  // By sets the faces of one block differ: those of joints have the colour of their set.
  const faceColourOf = function (f) {
    if (state.colourBy !== 'set') return colourOf(faceBlock[f]);
    return faceSet && faceSet[f] < setNames.length ? setColour(faceSet[f]) : staysColour;
  };

  return {
    data, bytes, triangles, faceBlock, faceRole, faceTriangles, blockId, batch, mode,
    factor, volume, faceCount, blocks, points, extent, indexOf, firstFace, firstTriangle,
    centre, judged, walls, isWall, batchColourOf, modeColours, factorSteps, volumeSteps, css,
    state, shown, colourOf, faceColourOf, setNames, usedSets, setColour, groups
  };
})();
