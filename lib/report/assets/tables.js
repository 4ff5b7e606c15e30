// Sortable tables. `row(id)` is the row of a block; `onPick` receives the number of the block whose row was clicked.
const tables = (function () {
  'use strict';
  const listeners = [], groupListeners = [];
  document.querySelectorAll('table.sortable').forEach(function (table) {
    const body = table.tBodies[0];
    const headings = Array.from(table.tHead.rows[0].cells);
    headings.forEach(function (heading, column) {
      heading.tabIndex = 0;
      const sort = function () {
        const down = heading.getAttribute('aria-sort') === 'ascending';
        headings.forEach(function (h) { h.removeAttribute('aria-sort'); });
        heading.setAttribute('aria-sort', down ? 'descending' : 'ascending');
        const value = function (row) {
          const cell = row.cells[column];
          const text = cell.dataset.v;
          return text === undefined ? cell.textContent : text === 'inf' ? Infinity : Number(text);
        };
        const rows = Array.from(body.rows).map(function (row, i) { return { row: row, v: value(row), i: i }; });
        rows.sort(function (a, b) { return (a.v < b.v ? -1 : a.v > b.v ? 1 : a.i - b.i) * (down ? -1 : 1); });
        rows.forEach(function (r) { body.appendChild(r.row); });
      };
      heading.addEventListener('click', sort);
      heading.addEventListener('keydown', function (e) { if (e.key === 'Enter' || e.key === ' ') { e.preventDefault(); sort(); } });
    });
    body.addEventListener('click', function (e) {
      const row = e.target.closest('tr');
      if (!row) return;
      if (row.dataset.group) groupListeners.forEach(function (f) { f(Number(row.dataset.group) - 1, row); });
      else listeners.forEach(function (f) { f(Number(row.dataset.block)); });
    });
  });

  const rowOf = new Map();
  document.querySelectorAll('tr[data-block]').forEach(function (row) { rowOf.set(Number(row.dataset.block), row); });

  // #sheet-12: block 12 alone, as a page to print.
  const sheet = function () {
    const link = /^#sheet-(\d+)$/.exec(location.hash);
    const one = link ? document.getElementById('why-' + link[1]) : null;
    document.querySelectorAll('#why > .one').forEach(function (d) { d.classList.remove('one'); });
    document.body.classList.toggle('sheet', one !== null);
    if (!one) return;
    one.classList.add('one');
    one.open = true;
    scrollTo(0, 0);
  };
  window.addEventListener('hashchange', sheet);
  sheet();

  return {
    row: function (id) {
      const row = rowOf.get(id);
      const micro = document.getElementById('show-micro');
      if (row && micro && row.classList.contains('micro')) micro.checked = true;
      return row;
    },
    onPick: function (listener) { listeners.push(listener); },
    onPickGroup: function (listener) { groupListeners.push(listener); }
  };
})();
