// Sortable tables. `row(id)` is the row of a block; `onPick` is told the number of the block whose row was clicked.
const tables = (function () {
  'use strict';
  const listeners = [];
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
      if (row) listeners.forEach(function (f) { f(Number(row.dataset.block)); });
    });
  });

  const rowOf = new Map();
  document.querySelectorAll('tr[data-block]').forEach(function (row) { rowOf.set(Number(row.dataset.block), row); });

  return {
    row: function (id) { return rowOf.get(id); },
    onPick: function (listener) { listeners.push(listener); }
  };
})();
