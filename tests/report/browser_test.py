#!/usr/bin/env python3
"""Drives report.html in a headless Chromium: `browser_test.py CHROMIUM CLEAVE SCENE WORK`.

The page gets one more script that clicks, types and presses keys as a reader would and writes what it found into the
page; the page is read back with --dump-dom. Without WebGL in the browser the 3D part is left out, and that is said.
"""
import html
import json
import re
import subprocess
import sys
from pathlib import Path

chromium, cleave, scene, work = sys.argv[1], sys.argv[2], sys.argv[3], Path(sys.argv[4])

DRIVER = r"""
<script>
window.addEventListener('load', function () {
  const found = {};
  const check = function (name, value) { found[name] = value; };
  try {
    const page = document.scrollingElement;
    check('fits', page.scrollWidth <= page.clientWidth);
    check('view', typeof view3d !== 'undefined' && view3d !== null);
    const row = document.querySelector('#keys tr[data-block]');
    const id = Number(row.dataset.block);
    const shown = function (e) { return e !== null && e.getClientRects().length > 0; };
    const sheet = /^#sheet-(\d+)$/.exec(location.hash);
    if (sheet) {
      const others = Array.from(document.querySelectorAll('main > section, #why > details')).filter(shown);
      check('sheet', others.length === 2 && others[1].id === 'why-' + sheet[1] && others[1].open);
      check('way back', shown(others[1].querySelector('.to-report')));
    }
    const micro = document.querySelector('#keys tr.micro');
    if (micro) {
      check('micro hidden', !shown(micro));
      document.getElementById('show-micro').click();
      check('micro shown', shown(micro));
    }
    const dark = getComputedStyle(document.body).backgroundColor;
    check('background', dark);
    document.querySelector('#keys th').click();
    check('sorts', document.querySelector('#keys th').getAttribute('aria-sort') === 'ascending');
    if (found.view) {
      const picked = function () { return view3d.state.picked < 0 ? -1 : view3d.blocks.id[view3d.state.picked]; };
      const key = function (name) { view3d.canvas.dispatchEvent(new KeyboardEvent('keydown', { key: name, bubbles: true, cancelable: true })); };
      check('link', location.hash === '#block-' + id ? picked() === id : 'no hash');
      key('Escape');
      check('escape', picked() === -1);
      row.click();
      check('row', picked() === id && row.classList.contains('picked'));
      key('i');
      check('alone', view3d.state.only === view3d.state.picked);
      key('Escape');
      check('together', view3d.state.only === -1);
      const search = document.getElementById('find');
      search.value = String(id);
      search.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter', bubbles: true, cancelable: true }));
      check('search', picked() === id);
      // The camera goes to a block that is shown alone; a click there picks it, and one beside it lets it go.
      key('i');
      key('f');
      const box = view3d.canvas.getBoundingClientRect(), alone = view3d.state.picked;
      const click = function (x, y) {
        ['pointerdown', 'pointerup'].forEach(function (type) {
          view3d.canvas.dispatchEvent(new PointerEvent(type, { clientX: x, clientY: y, button: 0, pointerId: 1, pointerType: 'mouse', bubbles: true }));
        });
      };
      view3d.mark(-1);
      click(box.left + box.width / 2, box.top + box.height / 2);
      check('click', alone >= 0 && view3d.state.picked === alone);
      click(box.left + 2, box.top + 2);
      check('click beside', view3d.state.picked !== alone);
      key('Escape');
      search.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter', bubbles: true, cancelable: true }));
      key('n');
      check('next', picked() >= 0);
      const group = document.querySelector('tr[data-group]');
      if (group) {
        group.click();
        const g = Number(group.dataset.group) - 1, first = view3d.groups[g].keys().next().value;
        check('group', view3d.state.group === g && blocks3d.shown(first) && group.classList.contains('picked') &&
          document.getElementById('picked').textContent.indexOf('Group ' + (g + 1)) === 0);
        check('group alone', blocks3d.blockId.every(function (n, b) { return blocks3d.shown(b) === view3d.groups[g].has(b); }));
        key('Escape');
        check('group let go', view3d.state.group === -1);
      }
      key('ArrowLeft'); key('+'); key('-'); key('Home'); key('f');
      view3d.parallel(true);
      view3d.parallel(false);
      const by = document.getElementById('colour-by');
      by.value = 'set';
      by.dispatchEvent(new Event('change'));
      const legend = Array.from(document.querySelectorAll('#panel fieldset')).find(function (f) { return shown(f) && f.firstChild.textContent === 'Joint set'; });
      const ofJoint = blocks3d.faceRole.findIndex(function (r, f) { return r === 0 && blocks3d.shown(blocks3d.faceBlock[f]); });
      const swatches = legend ? Array.from(legend.querySelectorAll('.swatch')).map(function (s) { return s.style.backgroundColor; }) : [];
      const colour = document.createElement('i');
      colour.style.backgroundColor = ofJoint < 0 ? '' : blocks3d.faceColourOf(ofJoint);
      check('sets', swatches.length > 0 && (ofJoint < 0 || swatches.indexOf(colour.style.backgroundColor) >= 0));
      // Areas of many sections, times their distance, are the volumes of the blocks.
      [0, 1, 2].forEach(function (axis) {
        const still = [0, 0, 0], n = 60, size = blocks3d.data.size[axis];
        let sum = 0, exact = 0, outlined = true;
        for (let i = 0; i < n; ++i) {
          const cap = caps3d(axis, ((i + 0.5) / n - 0.5) * size, function () { return true; }, function () { return still; });
          outlined = outlined && (cap.edges.length > 0) === (cap.block.length > 0) && cap.position.length === 9 * cap.block.length;
          for (let t = 0; t < cap.block.length; ++t) {
            const p = cap.position.slice(9 * t, 9 * t + 9), u = (axis + 1) % 3, v = (axis + 2) % 3;
            sum += Math.abs((p[3 + u] - p[u]) * (p[6 + v] - p[v]) - (p[3 + v] - p[v]) * (p[6 + u] - p[u])) / 2 * size / n;
          }
        }
        blocks3d.volume.forEach(function (v) { exact += v; });
        check('caps ' + 'xyz'[axis], outlined && Math.abs(sum / exact - 1) < 0.01 ? true : sum / exact);
      });
      // The section stands where the rock is cut off, also off the middle.
      check('caps at the cut', ['x', 'y', 'z'].every(function (axis) {
        view3d.state.axis = axis;
        view3d.state.cut = 0.3;
        view3d.rebuild();
        const at = view3d.caps.geometry.attributes.position;
        for (let i = 0; i < at.count; ++i) {
          if (Math.abs(view3d.section.distanceToPoint(new THREE.Vector3(at.getX(i), at.getY(i), at.getZ(i)))) > 1e-4 * view3d.extent) return false;
        }
        return at.count > 0;
      }));
      check('picture', view3d.picture().indexOf('data:image/png') === 0);
    }
  } catch (e) {
    check('error', String(e));
  }
  const out = document.createElement('pre');
  out.id = 'found';
  out.hidden = true;
  out.textContent = JSON.stringify(found);
  document.body.append(out);
});
</script>
"""


def drive(page, width, *more):
    flags = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             f"--user-data-dir={work / 'profile'}", f"--window-size={width},900", "--virtual-time-budget=10000", "--dump-dom"]
    done = subprocess.run([chromium, *flags, *more, page], capture_output=True, text=True, timeout=240)
    found = re.search(r'<pre id="found"[^>]*>(.*?)</pre>', done.stdout, re.S)
    if not found:
        sys.exit(f"the page did not come to its end: {done.stderr[-2000:]}")
    return json.loads(html.unescape(found.group(1)))


work.mkdir(parents=True, exist_ok=True)
out = work / "result"
subprocess.run([cleave, "run", scene, "-o", out, "--quiet"], check=True)
text = (out / "report.html").read_text()
page = work / "page.html"
page.write_text(text.replace("</body>", DRIVER + "</body>"))
block = re.search(r'<section id="keys">.*?<tr data-block="(\d+)"', text, re.S).group(1)
address = f"file://{page.resolve()}#block-{block}"

wide = drive(address, 1280)
print("1280 px:", wide)
expected = ["fits", "sorts"] + [name for name in ["micro hidden", "micro shown"] if name in wide]
if wide["view"]:
    expected += ["link", "escape", "row", "alone", "together", "search", "next", "picture", "sets", "caps x", "caps y", "caps z", "caps at the cut"]
    expected += [name for name in ["group", "group alone", "group let go"] if "data-group" in text]
else:
    print("this browser has no WebGL: the 3D view was not driven")
wrong = [name for name in expected if wide.get(name) is not True] + (["error"] if "error" in wide else [])

# Chromium's window is at least 500 px wide, so the phone is a frame in the page.
def on_a_phone(name):
    frame = work / "phone.html"
    frame.write_text(f'<!doctype html><body style="margin:0"><iframe id="f" src="{name}" style="width:390px;height:800px;border:0"></iframe>'
                     '<script>window.addEventListener("load",function(){const d=document.getElementById("f").contentDocument;'
                     'const p=document.createElement("pre");p.id="found";const r=d&&d.scrollingElement;'
                     'p.textContent=JSON.stringify({scroll:r?r.scrollWidth:-1,width:r?r.clientWidth:-1'
                     '});document.body.append(p);});</script>')
    phone = drive(f"file://{frame.resolve()}", 800, "--allow-file-access-from-files")
    print("390 px:", name, phone)
    return 0 < phone["scroll"] <= phone["width"]


if not on_a_phone("page.html"):
    wrong.append("390 px")

# The page of an ensemble, with a name that has no place to break.
many = work / "an_ensemble_of_a_wedge_whose_name_is_as_long_as_names_of_files_can_be.toml"
many.write_text("""[domain]
box = { min = [0, 0, 0], max = [8, 8, 6] }
[[joint_set]]
name = "A"
orientation = { dip = 45, dip_direction = 90, distribution = "fisher", kappa = 5 }
size = { distribution = "constant", mean = 12 }
intensity = { count = 12 }
[joints.default]
friction = 20
[rock]
density = 2700
[stability]
free = ["top", "east"]
[monte_carlo]
realizations = 8
""")
subprocess.run([cleave, "run", many, "-o", work / "ensemble", "--quiet"], check=True)
if not on_a_phone("ensemble/report.html"):
    wrong.append("390 px of an ensemble")

explained = re.search(r'<details id="why-(\d+)"', text).group(1)
sheet = drive(f"file://{page.resolve()}#sheet-{explained}", 1280)
print("sheet:", sheet)
wrong += [name for name in ["sheet", "way back"] if sheet.get(name) is not True]
paper = work / "sheet.pdf"
subprocess.run([chromium, "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", f"--user-data-dir={work / 'profile'}",
                "--no-pdf-header-footer", f"--print-to-pdf={paper}", f"file://{(out / 'report.html').resolve()}#sheet-{explained}"],
               capture_output=True, timeout=240)
pages = len(re.findall(rb"/Type\s*/Page\b", paper.read_bytes())) if paper.exists() else 0
print("sheet on paper:", pages, "pages")
if not 1 <= pages <= 2:
    wrong.append("sheet on paper")

dark = drive(address, 1280, "--blink-settings=preferredColorScheme=0")
print("dark:", dark["background"])
if dark["background"] == wide["background"]:
    wrong.append("dark")
if wrong:
    sys.exit("wrong: " + ", ".join(wrong))
