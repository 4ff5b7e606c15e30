// node check.mjs cleave.wasm hashes.txt [PROGRAM]: the block systems of the golden file, hashed in WebAssembly, are those
// of the native builds; and scene.json gives the blocks and key blocks that PROGRAM finds for the same scene.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { load } from './cleave.mjs';

const [wasm, golden, program] = process.argv.slice(2);
const cleave = await load(readFileSync(wasm));
let wrong = 0, right = 0;
function expect(what, ours, theirs) {
  if (ours === theirs) {
    right += 1;
  } else {
    wrong += 1;
    console.log(`${what}: ${ours} in WebAssembly, ${theirs} natively`);
  }
}

for (const line of readFileSync(golden, 'utf8').trim().split('\n')) {
  const [name, hash] = line.split(' ');
  if (name === 'rect-13-tunnel') continue; // not one of the named workloads
  expect(name, cleave.hashOfWorkload(name), hash);
}

const here = dirname(fileURLToPath(import.meta.url));
const scene = JSON.parse(readFileSync(join(here, 'scene.json'), 'utf8'));
const started = performance.now();
const ours = cleave.cut(scene);
const seconds = (performance.now() - started) / 1000;
let key = 0, volume = 0;
ours.key.forEach(function (is, b) {
  if (is && ours.batch[b] !== 0) {
    key += 1;
    volume += ours.volume[b];
  }
});
if (program) {
  const half = scene.side / 2;
  const sets = scene.sets.map(function (set, s) {
    return `[[joint_set]]\nname = "${s + 1}"\nmodel = "baecher"\nshape = "disc"\nsides = 12\n` +
      `orientation = { dip = ${set.dip}, dip_direction = ${set.dip_direction}, distribution = "fisher", kappa = ${set.kappa} }\n` +
      `size = { distribution = "exponential", mean = ${set.diameter} }\nintensity = { p32 = ${set.p32} }\n` +
      `[joints.${s + 1}]\nfriction = ${set.friction}\n`;
  });
  const folder = mkdtempSync(join(tmpdir(), 'cleave-'));
  writeFileSync(join(folder, 'scene.toml'), `schema = 1\nseed = ${scene.seed}\n` +
    `[domain]\nbox = { min = [${-half}, ${-half}, ${-half}], max = [${half}, ${half}, ${half}] }\n${sets.join('')}` +
    `[stability]\ngroups = "off"\n[output]\nvtu = false\nreport = false\n[rock]\ndensity = ${scene.density}\n[[excavation]]\nname = "tunnel"\nkind = "tunnel"\n` +
    `section = { shape = "horseshoe", width = ${scene.width}, height = ${scene.height} }\naxis = [[0, ${-half}, 0], [0, ${half}, 0]]\n`);
  execFileSync(program, ['run', join(folder, 'scene.toml'), '-o', join(folder, 'out'), '--quiet']);
  const theirs = JSON.parse(readFileSync(join(folder, 'out', 'summary.json'), 'utf8'));
  rmSync(folder, { recursive: true });
  expect('blocks', ours.volume.length, theirs.blocks.count);
  expect('hash', ours.hash, theirs.blocks.hash);
  expect('key blocks', key, theirs.key_blocks.count);
  expect('their volume', volume.toPrecision(9), theirs.key_blocks.volume_m3.toPrecision(9));
}
console.log(`${ours.volume.length} blocks, ${key} key blocks (${volume.toFixed(2)} m3) in ${seconds.toFixed(2)} s`);
console.log(`${right} equal, ${wrong} not`);
process.exit(wrong === 0 ? 0 : 1);
