// The eye of the 3D view: camera, controls, compass and scale bar of the canvas of `renderer`; draws `scene` when asked to.
// `at` says what is looked at: the extent of everything, the middle and reach of what matters, and how far blocks are moved.
const camera3d = function (holder, renderer, scene, state, at) {
  'use strict';
  const { points, triangles, firstFace, firstTriangle, css } = blocks3d;
  const { extent } = at;
  const camera = new THREE.PerspectiveCamera(32, 1, extent / 500, extent * 20);
  camera.up.set(0, 0, 1);
  const lamp = new THREE.DirectionalLight(0xffffff, 0.42);
  camera.add(lamp);
  lamp.position.set(-0.6, 0.9, 1);
  scene.add(camera);
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  controls.screenSpacePanning = true;
  controls.enableKeys = false;

  const compass = document.getElementById('compass');
  const drawCompass = function () {
    const arrows = [['E', new THREE.Vector3(1, 0, 0)], ['N', new THREE.Vector3(0, 1, 0)], ['up', new THREE.Vector3(0, 0, 1)]];
    let text = '<svg viewBox="-42 -42 84 84">';
    const turn = camera.matrixWorldInverse;
    arrows.map(function (a) { return [a[0], a[1].transformDirection(turn)]; })
      .sort(function (a, b) { return a[1].z - b[1].z; })
      .forEach(function (a) {
        const x = (26 * a[1].x).toFixed(1), y = (-26 * a[1].y).toFixed(1);
        text += '<line x1="0" y1="0" x2="' + x + '" y2="' + y + '" stroke="' + css('--ink') + '" stroke-width="1.8" opacity="' + (a[1].z < -0.2 ? 0.4 : 1) + '"/>' +
          '<text text-anchor="middle" x="' + (35 * a[1].x).toFixed(1) + '" y="' + (4 - 35 * a[1].y).toFixed(1) + '">' + a[0] + '</text>';
      });
    compass.innerHTML = text + '</svg>';
  };

  let pending = false;
  // The bar is as long as a round number of metres at the distance of what is looked at.
  const scaleBar = document.createElement('div');
  scaleBar.id = 'scale-bar';
  holder.append(scaleBar);
  const drawScale = function () {
    const height = renderer.domElement.clientHeight || 1;
    const metres = 2 * camera.position.distanceTo(controls.target) * Math.tan(camera.fov * Math.PI / 360) / height;
    const power = Math.pow(10, Math.floor(Math.log10(120 * metres)));
    const length = [5, 2, 1].map(function (m) { return m * power; }).find(function (l) { return l <= 120 * metres; }) || power;
    scaleBar.style.width = (length / metres).toFixed(1) + 'px';
    scaleBar.textContent = Number(length.toPrecision(3)) + ' m';
  };
  const draw = function () {
    pending = false;
    renderer.render(scene, camera);
    drawCompass();
    drawScale();
  };
  const render = function () {
    if (!pending) { pending = true; requestAnimationFrame(draw); }
  };
  const resize = function () {
    const box = holder.getBoundingClientRect();
    if (box.width < 2 || box.height < 2) return;
    renderer.setSize(box.width, box.height, false);
    camera.aspect = box.width / box.height;
    camera.updateProjectionMatrix();
    render();
  };
  const look = function (direction, target, radius) {
    const d = new THREE.Vector3(direction[0], direction[1], direction[2]).normalize();
    const narrow = Math.min(1, camera.aspect);
    const distance = radius / Math.sin(camera.fov * Math.PI / 360) / narrow;
    camera.near = Math.max(distance - 20 * extent, extent / 500);
    camera.far = distance + 20 * extent;
    camera.updateProjectionMatrix();
    controls.target.set(target[0], target[1], target[2]);
    camera.position.copy(controls.target).addScaledVector(d, distance * 0.86);
    camera.lookAt(controls.target);
    controls.update();
    render();
  };
  const home = function () { look([0.62, -1, 0.55], at.focus, at.reach); };

  // ---- going about -------------------------------------------------------------------------------------------------
  const direction = function () {
    const d = new THREE.Vector3().subVectors(camera.position, controls.target);
    return [d.x, d.y, d.z];
  };
  const zoomTo = function (...members) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    members.forEach(function (b) {
      const move = at.offsetOf(b);
      for (let i = 3 * firstTriangle[firstFace[b]]; i < 3 * firstTriangle[firstFace[b + 1]]; ++i) {
        for (let k = 0; k < 3; ++k) {
          const v = points[3 * triangles[i] + k] + move[k];
          low[k] = Math.min(low[k], v); high[k] = Math.max(high[k], v);
        }
      }
    });
    if (low[0] > high[0]) return;
    const middle = low.map(function (v, k) { return (v + high[k]) / 2; });
    const radius = Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) / 2;
    look(direction(), middle, Math.max(1.6 * radius, extent / 200));
  };
  const turn = function (sideways, upwards) {
    const d = new THREE.Spherical().setFromVector3(new THREE.Vector3().subVectors(camera.position, controls.target).applyAxisAngle(new THREE.Vector3(1, 0, 0), -Math.PI / 2));
    d.theta += sideways;
    d.phi = Math.min(Math.PI - 0.01, Math.max(0.01, d.phi - upwards));
    camera.position.copy(new THREE.Vector3().setFromSpherical(d).applyAxisAngle(new THREE.Vector3(1, 0, 0), Math.PI / 2)).add(controls.target);
    camera.lookAt(controls.target);
    controls.update();
    render();
  };
  const zoom = function (factor) {
    camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
    controls.update();
    render();
  };
  // From so far away that parallel lines stay parallel to the eye.
  const parallel = function (on) {
    const radius = camera.position.distanceTo(controls.target) * Math.tan(camera.fov * Math.PI / 360);
    state.parallel = on;
    camera.fov = on ? 1 : 32;
    camera.position.sub(controls.target).setLength(radius / Math.tan(camera.fov * Math.PI / 360)).add(controls.target);
    const distance = camera.position.distanceTo(controls.target);
    camera.near = Math.max(distance - 20 * extent, extent / 500);
    camera.far = distance + 20 * extent;
    camera.updateProjectionMatrix();
    controls.update();
    render();
  };
  const picture = function () {
    renderer.render(scene, camera);
    return renderer.domElement.toDataURL('image/png');
  };

  controls.addEventListener('change', render);
  window.addEventListener('resize', resize);
  return { camera: camera, render: render, resize: resize, look: look, home: home, zoomTo: zoomTo, turn: turn, zoom: zoom, parallel: parallel, picture: picture };
};
