// Beside the 3D view: what it shows and how, and the figures of the block that was picked, in the view or in a table.
(function () {
  'use strict';
  if (!view3d) return;
  const state = view3d.state, blocks = view3d.blocks;
  const modeNames = ['falling', 'lifting', 'sliding', 'wedge', 'stable', 'tapered'];

  const panel = document.getElementById('panel');
  panel.hidden = false;
  const make = function (tag, attributes, parent) {
    const element = document.createElement(tag);
    Object.keys(attributes || {}).forEach(function (k) {
      if (k === 'text') element.textContent = attributes[k]; else element.setAttribute(k, attributes[k]);
    });
    if (parent) parent.append(element);
    return element;
  };
  const fieldset = function (title) {
    const f = make('fieldset', {}, panel);
    make('legend', { text: title }, f);
    return f;
  };
  const slider = function (parent, text, value, min, max, change) {
    const label = make('label', { class: 'range' }, parent);
    make('span', { text: text }, label);
    const input = make('input', { type: 'range', min: min, max: max, step: (max - min) / 100, value: value, 'aria-label': text }, label);
    input.addEventListener('input', function () { change(Number(input.value)); });
    return input;
  };
  const legend = {};
  const steps = function (title, rows) {
    const field = fieldset(title);
    rows.forEach(function (s) {
      const line = make('label', {}, field);
      make('i', { class: 'swatch', style: 'background:' + s[1] }, line);
      make('span', { text: s[0] }, line);
    });
    return field;
  };
  const judged = state.batches.size > 0;
  const by = fieldset(judged ? 'Key blocks' : 'Blocks');
  const label = make('label', {}, by);
  make('span', { text: 'Colour by' }, label);
  const select = make('select', { id: 'colour-by', 'aria-label': 'Colour by' }, label);
  const kinds = judged ? [['batch', 'batch'], ['mode', 'mode'], ['factor', 'factor of safety'], ['volume', 'volume']] : [['batch', 'nothing'], ['volume', 'volume']];
  if (view3d.setNames.length > 0) kinds.push(['set', 'joint set']);
  kinds.forEach(function (o) { make('option', { value: o[0], text: o[1] }, select); });
  select.addEventListener('change', function () { state.colourBy = select.value; swatches(); view3d.rebuild(); });
  legend.volume = steps('Volume', view3d.volumeSteps);
  legend.set = steps('Joint set', view3d.setNames.map(function (name, s) { return [name, view3d.setColour(s), s]; })
    .filter(function (row) { return view3d.usedSets.has(row[2]); }));
  if (judged) {
    const list = function (title, map, names, colours) {
      const field = fieldset(title);
      const box = make('div', { class: 'list' }, field);
      Array.from(map.keys()).sort(function (a, b) { return (a || 99) - (b || 99); }).forEach(function (key) {
        const entry = map.get(key), line = make('label', {}, box);
        const input = make('input', { type: 'checkbox' }, line);
        input.checked = entry.on;
        input.addEventListener('change', function () { entry.on = input.checked; view3d.rebuild(); });
        make('i', { class: 'swatch', style: 'background:' + colours(key) }, line);
        make('span', { text: names(key) }, line);
        make('span', { class: 'n', text: String(entry.n) }, line);
      });
      return field;
    };
    legend.batch = list('Batch', state.batches, function (k) { return k === 0 ? 'no batch: stays' : k > 8 ? 'batch 9 and later' : 'batch ' + k; },
      view3d.batchColour);
    legend.mode = list('Mode', state.modes, function (k) { return modeNames[k]; }, view3d.modeColour);
    legend.factor = steps('Factor of safety', view3d.factorSteps);
  }
  const swatches = function () {
    Object.keys(legend).forEach(function (name) {
      legend[name].querySelectorAll('.swatch').forEach(function (s) { s.style.display = name === state.colourBy ? '' : 'none'; });
    });
    ['factor', 'volume', 'set'].forEach(function (name) { if (legend[name]) legend[name].style.display = state.colourBy === name ? '' : 'none'; });
  };
  swatches();
  const find = fieldset('Find a block');
  const line = make('label', {}, find);
  const search = make('input', { type: 'number', min: 0, step: 1, id: 'find', placeholder: 'number', 'aria-label': 'Number of the block to find' }, line);
  const found = make('span', { class: 'small', 'aria-live': 'polite' }, line);
  const goTo = function (id) {
    const known = view3d.indexOf.has(id);
    found.textContent = known ? '' : tables.row(id) ? 'not in the view' : 'not shown here';
    if (!known) return false;
    pick(view3d.indexOf.get(id), true);
    view3d.zoomTo(state.picked);
    return true;
  };
  search.addEventListener('change', function () { if (search.value !== '') goTo(Number(search.value)); });
  search.addEventListener('keydown', function (e) { if (e.key === 'Enter' && search.value !== '') { e.preventDefault(); goTo(Number(search.value)); } });
  const view = fieldset('Rock');
  if (view3d.walls) slider(view, 'Walls', state.wallOpacity, 0, 1, function (v) {
    const crossing = (v > 0) !== (state.wallOpacity > 0);
    state.wallOpacity = v;
    if (crossing) view3d.rebuild(); else view3d.restyle();
  });
  slider(view, 'The rest', state.restOpacity, 0, 1, function (v) {
    const crossing = (v > 0) !== (state.restOpacity > 0) || (v >= 0.2) !== (state.restOpacity >= 0.2);
    state.restOpacity = v;
    if (crossing) view3d.rebuild(); else view3d.restyle();
  });
  slider(view, 'Explode', 0, 0, 1, function (v) { state.explode = v; view3d.rebuild(); });
  const cutLine = make('label', { class: 'range' }, view);
  make('span', { text: 'Cut along' }, cutLine);
  const axis = make('select', { 'aria-label': 'Axis of the cut' }, cutLine);
  [['y', 'y'], ['x', 'x'], ['z', 'z']].forEach(function (o) { make('option', { value: o[0], text: o[1] }, axis); });
  const cut = make('input', { type: 'range', min: 0, max: 1, step: 0.01, value: 1, 'aria-label': 'Position of the cut' }, cutLine);
  const change = function () {
    const crossing = (Number(cut.value) < 1) !== (state.cut < 1);
    state.axis = axis.value;
    state.cut = Number(cut.value);
    if (crossing) view3d.rebuild(); else view3d.restyle();
  };
  axis.addEventListener('change', change);
  cut.addEventListener('input', change);
  if (view3d.bolts) {
    const field = fieldset('Bolts');
    const box = make('div', { class: 'list' }, field);
    view3d.bolts.forEach(function (b) {
      if (b.count === 0) return;
      const line = make('label', {}, box);
      const input = make('input', { type: 'checkbox' }, line);
      input.checked = true;
      input.addEventListener('change', function () { b.on = input.checked; view3d.restyle(); });
      make('i', { class: 'swatch', style: 'background:' + b.colour }, line);
      make('span', { text: b.name }, line);
      make('span', { class: 'n', text: String(b.count) }, line);
    });
  }
  const parallelLine = make('label', {}, view);
  const parallel = make('input', { type: 'checkbox' }, parallelLine);
  make('span', { text: 'Parallel projection' }, parallelLine);
  parallel.addEventListener('change', function () { view3d.parallel(parallel.checked); });
  const savePicture = function () {
    const link = make('a', { href: view3d.picture(), download: 'blocks.png' }, document.body);
    link.click();
    link.remove();
  };
  const buttons = make('div', { class: 'buttons' }, panel);
  [['Start view', view3d.home],
    ['Whole', function () { view3d.look([0.62, -1, 0.55], [0, 0, 0], view3d.extent / 2 * (1 + state.explode)); }],
    ['Top', function () { view3d.look([0, -0.001, 1], view3d.focus, view3d.reach); }],
    ['From south', function () { view3d.look([0, -1, 0], view3d.focus, view3d.reach); }],
    ['From east', function () { view3d.look([1, 0, 0], view3d.focus, view3d.reach); }],
    ['Save picture', savePicture]].forEach(function (b) {
    make('button', { type: 'button', text: b[0] }, buttons).addEventListener('click', b[1]);
  });
  const pickedBox = make('div', { id: 'picked', 'aria-live': 'polite' }, view3d.place);

  // One block without the other key blocks, among rock that is faint.
  const only = function (b) {
    state.only = b;
    view3d.rebuild();
  };

  // ---- the picked block -------------------------------------------------------------------------------------------
  const short = function (v) { return !isFinite(v) || v >= 1e9 ? '\u221e' : String(Number(v.toPrecision(4))); };
  const pick = function (b, scroll) {
    if (state.picked >= 0) {
      const old = tables.row(blocks.id[state.picked]);
      if (old) old.classList.remove('picked');
    }
    pickedBox.textContent = '';
    if (state.only >= 0 && state.only !== b) only(-1);
    if (b >= 0) {
      const row = tables.row(blocks.id[b]);
      if (row) {
        row.classList.add('picked');
        const box = row.closest('.scroll');
        if (scroll && box) box.scrollTop = row.offsetTop - box.clientHeight / 2;
      }
      const head = make('div', { class: 'buttons' }, pickedBox);
      make('strong', { text: 'Block ' + blocks.id[b] }, head);
      make('button', { type: 'button', text: 'Go to it' }, head).addEventListener('click', function () { view3d.zoomTo(b); });
      const alone = make('button', { type: 'button', text: 'Alone', 'aria-pressed': String(state.only === b) }, head);
      alone.addEventListener('click', function () { only(state.only === b ? -1 : b); alone.setAttribute('aria-pressed', String(state.only === b)); });
      make('a', { href: '#block-' + blocks.id[b], text: 'Link' }, head);
      const list = make('dl', {}, pickedBox);
      const fact = function (name, value) { const pair = make('div', {}, list); make('dt', { text: name }, pair); make('dd', { text: value }, pair); };
      if (row) {
        const heads = row.closest('table').tHead.rows[0].cells;
        for (let i = 1; i < heads.length; ++i) fact(heads[i].textContent, row.cells[i].textContent);
      } else {
        fact('Volume (m\u00b3)', short(blocks.volume[b]));
        fact('Faces', String(blocks.faces[b]));
        fact('State', blocks.mode[b] === 255 ? 'no free face, fixed, or not removable' : modeNames[blocks.mode[b]]);
      }
      if (view3d.bolts) fact('Bolts that serve it', String(view3d.servingBolts(b)));
      // Its faces, forces and why it moves stand further down, for readers without a pointer too.
      const why = document.getElementById('why-' + blocks.id[b]);
      if (why) {
        const details = make('div', { class: 'why' }, pickedBox);
        Array.from(why.children).forEach(function (part) {
          if (part.tagName !== 'SUMMARY') details.append(part.cloneNode(true));
        });
        const link = make('a', { href: '#why-' + blocks.id[b], text: 'Show below' }, pickedBox);
        link.addEventListener('click', function () { why.open = true; });
      }
    } else {
      make('span', { class: 'small', text: 'Click a block to see its figures.' }, pickedBox);
    }
    view3d.mark(b);
  };
  view3d.onPick(function (b) { pick(b, true); });
  tables.onPick(function (id) {
    if (!view3d.indexOf.has(id)) return;
    if (state.group >= 0) pickGroup(-1);
    pick(view3d.indexOf.get(id), false);
    view3d.zoomTo(state.picked);
    view3d.holder.scrollIntoView({ block: 'nearest' });
  });

  // ---- a group as one: alone, with an arrow on each block, and its first motion drawn large ------------------------
  let playing = 0;
  const stop = function () { cancelAnimationFrame(playing); playing = 0; state.moved = 0; };
  const pickGroup = function (g) {
    stop();
    document.querySelectorAll('tr[data-group]').forEach(function (row) {
      row.classList.toggle('picked', Number(row.dataset.group) === g + 1);
    });
    only(-1);
    pick(-1, false);
    state.group = g;
    if (g >= 0) {
      const members = Array.from(view3d.groups[g].keys());
      pickedBox.textContent = '';
      const head = make('div', { class: 'buttons' }, pickedBox);
      make('strong', { text: 'Group ' + (g + 1) + ': ' + members.length + (members.length === 1 ? ' block' : ' blocks') }, head);
      make('button', { type: 'button', text: 'Go to it' }, head).addEventListener('click', function () { view3d.zoomTo(...members); });
      const play = make('button', { type: 'button', text: 'Move', 'aria-label': 'Show how the group starts to move' }, head);
      play.addEventListener('click', function () {
        if (playing) { stop(); view3d.rebuild(); return; }
        const start = performance.now();
        const frame = function (now) {
          state.moved = 0.5 - 0.5 * Math.cos((now - start) / 1000 * Math.PI / 1.5);
          view3d.rebuild();
          playing = requestAnimationFrame(frame);
        };
        playing = requestAnimationFrame(frame);
      });
      make('button', { type: 'button', text: 'Let go' }, head).addEventListener('click', function () { pickGroup(-1); });
      make('p', { class: 'small', text: 'Arrows: first motion of each block, drawn large. Groups in doubt have none.' }, pickedBox);
      if (members.length > 0) view3d.zoomTo(...members);
    }
    view3d.rebuild();
  };
  tables.onPickGroup(function (g) {
    if (!view3d.groups[g]) return;
    pickGroup(g);
    view3d.holder.scrollIntoView({ block: 'nearest' });
  });

  // ---- keys, and links to a block ---------------------------------------------------------------------------------
  const order = Array.from(view3d.indexOf.keys()).filter(function (id) { return blocks.mode[view3d.indexOf.get(id)] < 4; }).sort(function (a, b) { return a - b; });
  const step = function (by) {
    if (order.length === 0) return;
    const at = state.picked >= 0 ? order.indexOf(blocks.id[state.picked]) : by > 0 ? -1 : 0;
    goTo(order[(at + by + order.length) % order.length]);
  };
  const keys = {
    ArrowLeft: function () { view3d.turn(-0.1, 0); }, ArrowRight: function () { view3d.turn(0.1, 0); },
    ArrowUp: function () { view3d.turn(0, 0.1); }, ArrowDown: function () { view3d.turn(0, -0.1); },
    '+': function () { view3d.zoom(0.87); }, '=': function () { view3d.zoom(0.87); }, '-': function () { view3d.zoom(1.15); },
    n: function () { step(1); }, p: function () { step(-1); }, Home: view3d.home,
    f: function () { if (state.picked >= 0) view3d.zoomTo(state.picked); },
    i: function () { if (state.picked >= 0) { const b = state.picked; only(state.only === b ? -1 : b); } },
    Escape: function () { if (state.group >= 0) pickGroup(-1); else { only(-1); pick(-1, false); } }
  };
  view3d.canvas.addEventListener('keydown', function (e) {
    const key = keys[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    if (!key || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    key();
  });
  const follow = function () {
    const link = /^#block-(\d+)$/.exec(location.hash);
    if (link && goTo(Number(link[1]))) view3d.holder.scrollIntoView({ block: 'nearest' });
  };
  window.addEventListener('hashchange', follow);

  pick(-1, false);
  view3d.start();
  follow();
})();
