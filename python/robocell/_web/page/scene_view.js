// SceneView draws a scene: shapes from `geometry`, poses of bodies from frames, with an orbit camera.
"use strict";
const RC = { SLOW_MS: 100 };

// Returns the header of packed bytes, and a function that returns the array of one of its entries.
RC.unpack = function (buffer) {
  const size = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  const types = { f4: Float32Array, u4: Uint32Array, i4: Int32Array, u1: Uint8Array };
  const array = (place) =>
    new types[place.type](buffer, 4 + size + place.at, place.shape.reduce((a, b) => a * b, 1));
  return [header, array];
};

RC.SceneView = class {
  constructor(parent) {
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("aria-label", "3D view: drag to turn, right drag to move, wheel to zoom");
    parent.append(this.canvas);
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.shadowMap.enabled = true;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0xdfe7ee);
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => (this.dirty = true));
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8f96, 1.6));
    this.sun = new THREE.DirectionalLight(0xffffff, 1.8);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.bias = -0.0005;
    this.scene.add(this.sun, this.sun.target);
    this.bodies = [];
    this.soft = []; // tendons, flexes and skins
    this.shown = { frames: "none", collision: false };
    this.dirty = true;
    let before = 0, slow = 0;
    const draw = (now) => {
      requestAnimationFrame(draw);
      this.resize();
      if (!this.dirty) { before = 0; return; }
      this.dirty = false;
      // A browser without a graphics card draws faster without shadows.
      slow = before && now - before > RC.SLOW_MS ? slow + 1 : 0;
      before = now;
      if (slow > 10) this.renderer.shadowMap.enabled = this.sun.castShadow = false;
      this.renderer.render(this.scene, this.camera);
    };
    requestAnimationFrame(draw);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const ratio = Math.min(devicePixelRatio, 2);
    if (!width || (this.width === width && this.height === height && this.ratio === ratio)) return;
    [this.width, this.height, this.ratio] = [width, height, ratio];
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  // Replaces the shapes by those of a geometry; the camera stays where it is after the first one.
  load(buffer) {
    const [header, array] = RC.unpack(buffer);
    const first = !this.header;
    this.header = header;
    for (const body of this.bodies) this.remove(body);
    this.bodies = header.bodies.map(() => new THREE.Group());
    this.scene.add(...this.bodies);
    const meshes = {}, textures = {};
    for (const [i, texture] of Object.entries(header.textures)) {
      const made = new THREE.DataTexture(array(texture.pixels), texture.width, texture.height, THREE.RGBAFormat);
      made.colorSpace = THREE.SRGBColorSpace;
      made.wrapS = made.wrapT = THREE.RepeatWrapping;
      made.generateMipmaps = true;
      made.minFilter = THREE.LinearMipmapLinearFilter;
      made.magFilter = THREE.LinearFilter;
      made.needsUpdate = true;
      textures[i] = made;
    }
    for (const kind of ["meshes", "hfields"]) {
      for (const [i, mesh] of Object.entries(header[kind])) {
        const made = new THREE.BufferGeometry();
        made.setAttribute("position", new THREE.BufferAttribute(array(mesh.vertices), 3));
        made.setIndex(new THREE.BufferAttribute(array(mesh.faces), 1));
        if (mesh.uvs) made.setAttribute("uv", new THREE.BufferAttribute(array(mesh.uvs), 2));
        if (mesh.normals) made.setAttribute("normal", new THREE.BufferAttribute(array(mesh.normals), 3));
        else made.computeVertexNormals();
        meshes[kind + i] = made;
      }
    }
    for (const part of this.soft) this.remove(part.shown);
    this.soft = header.soft.map((part) => this.makeSoft(part, array));
    for (const geom of header.geoms) this.bodies[geom.body].add(this.makeGeom(geom, meshes, textures));
    for (const frame of header.frames) this.bodies[frame.body].add(this.makeFrame(frame));
    header.bodies.forEach((name, i) => i && this.bodies[i].add(this.makeFrame({ name, kind: "body", pos: [0, 0, 0], quat: [0, 0, 0, 1] })));
    this.setPoses(array(header.poses));
    this.setPoints(array(header.points));
    if (first) this.look(header);
    this.show(this.shown);
  }

  remove(group) {
    group.traverse((each) => {
      each.geometry?.dispose();
      each.material?.map?.dispose();
      each.material?.dispose();
    });
    this.scene.remove(group);
  }

  look(header) {
    const at = new THREE.Vector3(...header.lookat);
    const far = header.distance;
    this.controls.target.copy(at);
    this.camera.position.set(at.x + 0.75 * far, at.y + 0.75 * far, at.z + 0.5 * far);
    this.camera.near = far / 200;
    this.camera.far = Math.max(far, header.extent) * 50;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.sun.target.position.copy(at);
    this.sun.position.set(at.x + far, at.y + 0.4 * far, at.z + 1.8 * far);
    const box = this.sun.shadow.camera;
    box.left = box.bottom = -1.2 * far;
    box.right = box.top = 1.2 * far;
    box.near = 0.1 * far;
    box.far = 5 * far;
    box.updateProjectionMatrix();
  }

  makeGeom(geom, meshes, textures) {
    const [a, b, c] = geom.size;
    let shape;
    if (geom.type === "plane") {
      const wide = 20 * Math.max(this.header.extent, this.header.distance);
      const width = a > 0 ? 2 * a : wide, height = b > 0 ? 2 * b : wide;
      shape = new THREE.PlaneGeometry(width, height);
      const repeat = geom.uniform || !(a > 0) ? [geom.repeat[0] * width, geom.repeat[1] * height] : geom.repeat;
      const uv = shape.attributes.uv;
      for (let i = 0; i < uv.count; ++i) uv.setXY(i, (uv.getX(i) - 0.5) * repeat[0], (uv.getY(i) - 0.5) * repeat[1]);
    } else if (geom.type === "sphere") shape = new THREE.SphereGeometry(a, 32, 16);
    else if (geom.type === "ellipsoid") shape = new THREE.SphereGeometry(1, 32, 16).scale(a, b, c);
    else if (geom.type === "capsule") shape = new THREE.CapsuleGeometry(a, 2 * b, 12, 24).rotateX(Math.PI / 2);
    else if (geom.type === "cylinder") shape = new THREE.CylinderGeometry(a, a, 2 * b, 32).rotateX(Math.PI / 2);
    else if (geom.type === "box") shape = new THREE.BoxGeometry(2 * a, 2 * b, 2 * c);
    else shape = meshes[(geom.type === "hfield" ? "hfields" : "meshes") + geom.mesh];
    const map = shape.attributes.uv ? textures[geom.texture] || null : null;
    const clear = geom.rgba[3] < 1;
    const material = new THREE.MeshStandardMaterial({
      color: new THREE.Color().setRGB(geom.rgba[0], geom.rgba[1], geom.rgba[2], THREE.SRGBColorSpace),
      map, opacity: geom.rgba[3], transparent: clear, depthWrite: !clear, roughness: 0.6,
      side: geom.type === "plane" || geom.type === "hfield" ? THREE.DoubleSide : THREE.FrontSide,
    });
    const mesh = new THREE.Mesh(shape, material);
    mesh.position.set(...geom.pos);
    mesh.quaternion.set(...geom.quat);
    mesh.castShadow = geom.type !== "plane" && !clear;
    mesh.receiveShadow = true;
    mesh.userData = { hidden: geom.hidden, body: geom.body };
    return mesh;
  }

  // A part that is no geom: segments are cylinders between pairs of points, a surface has triangles.
  makeSoft(part, array) {
    const material = new THREE.MeshStandardMaterial({
      color: new THREE.Color().setRGB(part.rgba[0], part.rgba[1], part.rgba[2], THREE.SRGBColorSpace),
      opacity: part.rgba[3], transparent: part.rgba[3] < 1, roughness: 0.7, side: THREE.DoubleSide,
    });
    let shown;
    if (part.kind === "segments") {
      const shape = new THREE.CylinderGeometry(part.radius, part.radius, 1, 10);
      shown = new THREE.Group();
      for (let i = 0; i < part.count / 2; ++i) shown.add(new THREE.Mesh(shape, material));
    } else {
      const shape = new THREE.BufferGeometry();
      shape.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * part.count), 3));
      shape.setIndex(new THREE.BufferAttribute(array(part.faces), 1));
      shown = new THREE.Mesh(shape, material);
    }
    shown.traverse((each) => {
      each.castShadow = each.receiveShadow = true;
      each.frustumCulled = false; // its bounds are not those of its moved points
    });
    this.scene.add(shown);
    return { ...part, shown };
  }

  setPoints(points) {
    const from = new THREE.Vector3(), to = new THREE.Vector3(), along = new THREE.Vector3(), up = new THREE.Vector3(0, 1, 0);
    for (const { kind, first, count, shown } of this.soft) {
      const own = points.subarray(3 * first, 3 * (first + count));
      if (kind === "segments") {
        shown.children.forEach((each, i) => {
          from.fromArray(own, 6 * i);
          to.fromArray(own, 6 * i + 3);
          const length = along.subVectors(to, from).length();
          each.visible = length > 0;
          if (!each.visible) return;
          each.position.copy(from.add(to).multiplyScalar(0.5));
          each.quaternion.setFromUnitVectors(up, along.divideScalar(length));
          each.scale.set(1, length, 1);
        });
      } else {
        shown.geometry.attributes.position.array.set(own);
        shown.geometry.attributes.position.needsUpdate = true;
        shown.geometry.computeVertexNormals();
      }
    }
    this.dirty = true;
  }

  makeFrame(frame) {
    const axes = new THREE.AxesHelper(0.06 * Math.max(this.header.distance, 0.5));
    axes.position.set(...frame.pos);
    axes.quaternion.set(...frame.quat);
    axes.userData = { frame: frame.kind };
    axes.visible = false;
    return axes;
  }

  setPoses(poses) {
    this.bodies.forEach((body, i) => {
      body.position.set(poses[7 * i], poses[7 * i + 1], poses[7 * i + 2]);
      body.quaternion.set(poses[7 * i + 3], poses[7 * i + 4], poses[7 * i + 5], poses[7 * i + 6]);
    });
    this.dirty = true;
  }

  // Shows frames of a kind ("none", "robot", "site", "camera", "body") and the geoms for collisions.
  show(changes) {
    Object.assign(this.shown, changes);
    for (const body of this.bodies) {
      for (const child of body.children) {
        if (child.userData.frame) child.visible = child.userData.frame === this.shown.frames;
        else child.visible = child.userData.hidden ? this.shown.collision : !this.shown.collision || !this.hasHidden();
      }
    }
    this.dirty = true;
  }

  hasHidden() {
    return this.header.geoms.some((geom) => geom.hidden);
  }

  // Direction of the camera in the world, as an angle about the vertical axis.
  azimuth() {
    const way = new THREE.Vector3().subVectors(this.controls.target, this.camera.position);
    return Math.atan2(way.y, way.x);
  }
};
