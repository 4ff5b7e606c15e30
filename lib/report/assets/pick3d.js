// Calls `listener` with the block that is clicked in the canvas of `renderer`, -1 for none. Each of `layers` has a mesh
// (`layer`), the least opacity at which it is picked from, what of it is `seen`, and the block of each triangle.
const pick3d = function (renderer, camera, layers, listener) {
  'use strict';
  const caster = new THREE.Raycaster();
  const blockAt = function (clientX, clientY) {
    const box = renderer.domElement.getBoundingClientRect();
    caster.setFromCamera({ x: 2 * (clientX - box.left) / box.width - 1, y: 1 - 2 * (clientY - box.top) / box.height }, camera);
    let best = null;
    layers.forEach(function (from) {
      if (!from.layer.visible || from.layer.material.opacity < from.least) return;
      caster.intersectObject(from.layer).forEach(function (hit) {
        if (!from.seen(hit.point)) return;
        if (!best || hit.distance < best.distance) best = { distance: hit.distance, block: from.blockOf(hit.faceIndex) };
      });
    });
    return best ? best.block : -1;
  };
  const down = { x: 0, y: 0 };
  renderer.domElement.addEventListener('pointerdown', function (e) { down.x = e.clientX; down.y = e.clientY; });
  renderer.domElement.addEventListener('pointerup', function (e) {
    if (e.button !== 0 || Math.hypot(e.clientX - down.x, e.clientY - down.y) > 5) return;
    listener(blockAt(e.clientX, e.clientY));
  });
};
