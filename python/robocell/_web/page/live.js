// The page of a running scene: pause, step, reset, speed, joints, cameras, frames.
"use strict";

RC.LivePage = class {
  constructor(app) {
    this.box = RC.element("div", { className: "view" });
    this.banner = RC.element("div", { className: "banner", role: "status" });
    this.box.append(this.banner);
    this.panel = RC.element("div", { className: "panel" }, RC.element("h1", {}, document.title));
    app.append(RC.element("div", { className: "stage" }, this.box), this.panel);
    this.view = new RC.SceneView(this.box);
    this.cameras = {};
    this.frames = 0;
    this.shownAt = this.between = 0; // ms
    this.connection = new RC.Connection((header, array) => this.onFrame(header, array), (open, why) => {
      document.documentElement.dataset.connected = open;
      if (!open) this.say(`The connection is closed${why ? `: ${why}` : ""}. Reload the page, or start the command again.`, "bad");
    }, (error) => this.say(`The picture is not of now: ${error.message}`, "bad"));
  }

  send(message) { this.connection.send(message); }

  say(text, kind = "") {
    this.banner.className = `banner ${kind}`;
    if (this.banner.textContent !== text) this.banner.textContent = text;
  }

  async onFrame(header, array) {
    if (!this.view.header || this.view.header.generation !== header.generation) {
      this.view.load(await (await RC.get("geometry")).arrayBuffer());
      this.build();
    }
    if (header.poses.shape[0] === this.view.bodies.length) this.view.setPoses(array(header.poses));
    if (header.points.shape[0] === this.view.header.points.shape[0]) this.view.setPoints(array(header.points));
    this.show(header, array);
    document.documentElement.dataset.frames = ++this.frames;
    const now = performance.now();
    this.between = Math.min(now - this.shownAt, 1000);
    this.shownAt = now;
  }

  // True if the picture is older than the time between frames allows.
  isStale() {
    return performance.now() - this.shownAt > Math.max(1000, 2 * this.between);
  }

  // Builds the panel for the scene's joints and cameras.
  build() {
    this.panel.replaceChildren(this.panel.firstChild, ...this.sections());
  }

  sections() {
    return [this.runSection(), this.jointSection(), this.cameraSection(), RC.viewSection(this.view)];
  }

  runSection() {
    this.pause = RC.toggle("Pause", (on) => this.send({ op: "pause", on }));
    const speed = RC.slider("speed", { lower: 0.1, upper: 2, value: 1, step: 0.1 }, (value) => this.send({ op: "speed", value }));
    this.speed = speed;
    this.timing = RC.element("p", { className: "note" });
    this.message = RC.element("p", { className: "error" });
    return RC.section("Run", true,
      RC.element("div", { className: "buttons" }, this.pause,
        RC.element("button", { type: "button", onclick: () => this.send({ op: "step" }) }, "Step"),
        RC.element("button", { type: "button", onclick: () => this.send({ op: "reset" }) }, "Reset")),
      speed, this.timing, this.message);
  }

  jointSection() {
    const { joints, grippers } = this.view.header;
    this.joints = joints.map((joint) => RC.slider(joint.name, { ...joint, step: (joint.upper - joint.lower) / 1000 },
      (value) => this.send({ op: "joint", name: joint.name, value })));
    this.openings = grippers.map((name) => RC.slider(`${name} opening`, { lower: 0, upper: 1, step: 0.01 },
      (value) => this.send({ op: "opening", name, value })));
    return RC.section("Joints", true, ...this.openings, ...this.joints);
  }

  cameraSection() {
    this.cameras = {};
    const section = RC.section("Cameras", false);
    for (const name of this.view.header.cameras) {
      const canvas = RC.element("canvas", { hidden: true });
      this.cameras[name] = canvas;
      const toggle = RC.toggle(name, (on) => { canvas.hidden = !on; this.send({ op: "camera", name, on }); });
      section.append(RC.element("div", { className: "camera" }, toggle, canvas));
    }
    return section;
  }

  show(header, array) {
    header.images.forEach(({ name, pixels }) => this.cameras[name] && RC.paint(this.cameras[name], pixels, array(pixels)));
    if (this.joints) {
      const values = array(header.joints);
      this.joints.forEach((row, i) => row.set(values[i]));
      header.openings.forEach((each, i) => this.openings[i]?.set(each.value));
    }
    if (!this.pause) return;
    this.pause.set(header.paused);
    this.speed.set(header.speed);
    this.timing.textContent = `${header.time.toFixed(2)} s, speed ${header.measured.toFixed(2)} of ${header.speed}, ` +
      `${header.work_ms.toFixed(1)} ms of work a frame`;
    this.message.textContent = header.message;
    this.say(header.diverged ? `The simulation diverged: ${header.diverged}. Reset begins again.` : "", "bad");
  }
};

RC.start.live = (app) => { RC.page = new RC.LivePage(app); };
