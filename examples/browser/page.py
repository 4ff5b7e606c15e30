#!/usr/bin/env python3
"""page.py WASM OUT: puts the page, three.js and the module into one file that asks no network."""
import base64
import sys
from pathlib import Path

here = Path(__file__).parent
three = Path("/usr/share/javascript/three")
parts = {
    "THREE": (three / "build/three.min.js").read_text(),
    "CONTROLS": (three / "examples/js/controls/OrbitControls.js").read_text(),
    "CLEAVE": (here / "cleave.mjs").read_text().replace("export ", ""),
    "SCENE": (here / "scene.json").read_text().strip(),
    "PAGE": (here / "page.js").read_text(),
    "WASM": base64.b64encode(Path(sys.argv[1]).read_bytes()).decode(),
}
page = (here / "page.html").read_text()
for name, text in parts.items():
    page = page.replace(f"/*{name}*/", text.replace("</script", "<\\/script"))
Path(sys.argv[2]).write_text(page)
