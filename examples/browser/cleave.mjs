// The cutter as a module of a page or of Node: `load(bytes)`, then `cut(scene)`.

const fields = ['dip', 'dip_direction', 'kappa', 'p32', 'diameter', 'friction'];
const arrays = [
  ['points', Float32Array], ['corners', Uint32Array], ['loopBegin', Uint32Array], ['faceLoopBegin', Uint32Array],
  ['faceBlock', Uint32Array], ['faceRole', Uint8Array], ['volume', Float64Array], ['factor', Float64Array],
  ['batch', Uint32Array], ['mode', Uint8Array], ['key', Uint8Array]
];
export const modes = ['falling', 'lifting', 'sliding', 'wedge', 'stable', 'tapered'];

// All that is asked of the system: a clock. Whatever else is called fails with "not supported".
function system(module, memory) {
  const calls = {
    clock_time_get: function (id, precision, at) {
      new DataView(memory().buffer).setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
      return 0;
    },
    environ_sizes_get: function (count, size) {
      const view = new DataView(memory().buffer);
      view.setUint32(count, 0, true);
      view.setUint32(size, 0, true);
      return 0;
    },
    environ_get: function () { return 0; },
    proc_exit: function (code) { throw new Error('cleave ended with code ' + code); }
  };
  const imports = {};
  for (const wanted of WebAssembly.Module.imports(module)) {
    imports[wanted.module] = imports[wanted.module] || {};
    imports[wanted.module][wanted.name] = calls[wanted.name] || function () { return 58; };
  }
  return imports;
}

export async function load(bytes) {
  const module = await WebAssembly.compile(bytes);
  let instance = null;
  instance = await WebAssembly.instantiate(module, system(module, function () { return instance.exports.memory; }));
  const cleave = instance.exports;
  cleave._initialize();

  function text(at) {
    const memory = new Uint8Array(cleave.memory.buffer);
    let end = at;
    while (memory[end] !== 0) end += 1;
    return new TextDecoder().decode(memory.subarray(at, end));
  }

  return {
    // scene: { sets: [three of { dip, dip_direction, kappa, p32, diameter, friction }], side, width, height, density,
    // seed }; degrees, metres, kg/m3. Throws what is wrong with it, in words.
    cut: function (scene) {
      const numbers = scene.sets.flatMap(function (set) { return fields.map(function (name) { return set[name]; }); });
      numbers.push(scene.side, scene.width, scene.height, scene.density, scene.seed);
      new Float64Array(cleave.memory.buffer, cleave.scene(), numbers.length).set(numbers);
      if (cleave.cut_scene() !== 0) throw new Error(text(cleave.message()));
      const result = { hash: text(cleave.hash()) };
      arrays.forEach(function ([name, Type], which) {
        const at = cleave.array(which), length = cleave.length();
        result[name] = length === 0 ? new Type(0) : new Type(cleave.memory.buffer, at, length).slice();
      });
      return result;
    },
    hashOfWorkload: function (name) {
      const at = cleave.name_of_workload(), memory = new Uint8Array(cleave.memory.buffer);
      memory.set(new TextEncoder().encode(name), at);
      memory[at + name.length] = 0;
      return text(cleave.hash_of_workload());
    }
  };
}
