// The page of a teleoperated session: buttons for its commands, and keys, pads and a phone as device.
"use strict";

RC.KEYS = {
  // key -> [array, axis, sign]; axes as the operator sees them: forward, left, up
  KeyW: ["linear", 0, 1], KeyS: ["linear", 0, -1], KeyA: ["linear", 1, 1], KeyD: ["linear", 1, -1],
  KeyR: ["linear", 2, 1], KeyF: ["linear", 2, -1],
  KeyJ: ["angular", 0, -1], KeyL: ["angular", 0, 1], KeyI: ["angular", 1, 1], KeyK: ["angular", 1, -1],
  KeyU: ["angular", 2, 1], KeyO: ["angular", 2, -1],
};
RC.COMMAND_KEYS = { Enter: "record", KeyY: "success", KeyN: "failure", KeyC: "resync", KeyZ: "reset_origin", KeyT: "next_arm", KeyQ: "quit", Backspace: "discard" };
RC.MOST_STREAMS = 2; // shown at the beginning
RC.METRES_PER_PIXEL = 0.0006;
RC.RADIANS_PER_PIXEL = 0.006;
RC.BANNERS = {
  waiting: ["Press Record (Enter) to begin", ""],
  countdown: ["Begins in", ""],
  recording: ["Recording", "bad"],
  review: ["Keep or discard the episode?", ""],
};

// The rotation of a phone, as a quaternion (w, x, y, z) from its axes to those of the earth: about z
// by alpha, then about its new x axis by beta, then about its new y axis by gamma, degrees.
RC.phoneRotation = function (alpha, beta, gamma) {
  const [a, b, g] = [alpha, beta, gamma].map((degrees) => ((degrees || 0) * Math.PI) / 360);
  const [ca, sa, cb, sb, cg, sg] = [a, b, g].flatMap((half) => [Math.cos(half), Math.sin(half)]);
  return [ca * cb * cg - sa * sb * sg, ca * sb * cg - sa * cb * sg, ca * cb * sg + sa * sb * cg, ca * sb * sg + sa * cb * cg];
};

// The rotation vector from one rotation of a phone to another, along the operator's forward, left, up.
// Right is where the phone's right edge points, on the floor, whether it lies flat or stands.
RC.phoneTurn = function (before, now) {
  const [w, x, y, z] = before, [w2, x2, y2, z2] = now;
  let real = w2 * w + x2 * x + y2 * y + z2 * z; // now times the inverse of before
  let vector = [x2 * w - w2 * x - y2 * z + z2 * y, y2 * w - w2 * y - z2 * x + x2 * z, z2 * w - w2 * z - x2 * y + y2 * x];
  if (real < 0) { real = -real; vector = vector.map((each) => -each); }
  const sine = Math.hypot(...vector);
  const scale = sine < 1e-9 ? 2 : (2 * Math.atan2(sine, real)) / sine;
  const [east, north, up] = vector.map((each) => each * scale);
  // To the left of the horizontal part of the phone's x axis.
  const fx = -2 * (x * y + w * z), fy = 1 - 2 * (y * y + z * z);
  const size = Math.hypot(fx, fy) || 1;
  return [(east * fx + north * fy) / size, (north * fx - east * fy) / size, up];
};

RC.TeleopPage = class extends RC.LivePage {
  constructor(app) {
    super(app);
    this.pressed = new Set();
    this.tapped = new Set(); // since the last input, also if they are let go
    this.drag = [0, 0, 0];
    this.turn = [0, 0, 0];
    this.opening = null;
    this.frame = "camera";
    this.speed_ = 1;
    this.phase = "";
    this.arm = "";
    addEventListener("keydown", (event) => this.onKey(event, true));
    addEventListener("keyup", (event) => this.onKey(event, false));
    addEventListener("blur", () => this.release());
    document.addEventListener("visibilitychange", () => document.hidden && this.release());
    document.addEventListener("focusin", (event) => event.target.matches("input[type=search], select") && this.release());
    setInterval(() => this.sendInput(), 33);
  }

  sections() {
    return [this.sessionSection(), this.driveSection(), this.streamSection(), RC.viewSection(this.view)];
  }

  sessionSection() {
    const button = (name, text, title) => {
      const made = RC.element("button", { type: "button", title, onclick: () => { this.command(name); made.blur(); } }, text);
      made.dataset.command = name;
      return made;
    };
    this.buttons = [
      button("record", "Record", "Enter"), button("success", "Success", "Y"), button("failure", "Failure", "N"),
      button("keep", "Keep", "Enter"), button("discard", "Discard", "Backspace"),
      button("resync", "Re-sync", "C"), button("reset_origin", "Reset origin", "Z"),
      button("next_arm", "Next arm", "T"), button("quit", "Quit", "Q"),
    ];
    this.buttons.find((each) => each.dataset.command === "next_arm").hidden = true;
    this.instruction = RC.element("p");
    this.state = RC.element("p", { className: "note", role: "status" });
    return RC.section("Session", true, this.instruction, RC.element("div", { className: "buttons" }, ...this.buttons), this.state);
  }

  driveSection() {
    const frame = RC.element("select", { ariaLabel: "axes", onchange: () => { this.frame = frame.value; frame.blur(); } });
    for (const [value, text] of [["camera", "axes of this view"], ["base", "axes of the base"], ["tool", "axes of the tool"]])
      frame.append(RC.element("option", { value }, text));
    this.clutch = RC.toggle("Clutch", () => { this.release(); this.clutch.blur(); }, true);
    this.grip = RC.toggle("Close gripper", (on) => { this.setOpening(on ? 0 : 1); this.grip.blur(); });
    const speed = RC.slider("speed", { lower: 0.1, upper: 1, value: 1, step: 0.1 }, (value) => (this.speed_ = value));
    const key = (text) => RC.element("kbd", {}, text);
    this.drive = RC.section("Drive", true,
      RC.element("div", { className: "buttons" }, frame, this.clutch, this.grip), speed,
      RC.element("div", { className: "pads" }, this.pad("forward, left", "move", 0, 1), this.pad("up, down", "lift", 2, null),
        this.pad("roll, pitch", "tilt", 0, 1), this.pad("yaw", "yaw", null, 2)),
      RC.element("p", { className: "note" }, key("W"), key("S"), " forward, back ", key("A"), key("D"), " left, right ", key("R"), key("F"),
        " up, down ", key("I"), key("K"), " pitch ", key("J"), key("L"), " roll ", key("U"), key("O"), " yaw ", key("Space"), " gripper ",
        key("Shift"), " slow"),
      this.phoneButton());
    return this.drive;
  }

  // The images lie over the view, where the operator looks.
  streamSection() {
    this.cameras = {};
    this.overlay?.remove();
    this.overlay = RC.element("div", { className: "overlay" });
    this.box.append(this.overlay);
    const buttons = RC.element("div", { className: "buttons" });
    (this.streams || []).forEach((name, i) => {
      const on = i < RC.MOST_STREAMS;
      const canvas = RC.element("canvas", { hidden: true, ariaLabel: name });
      const show = (shown) => { if (!shown) canvas.hidden = true; canvas.wanted = shown; this.send({ op: "camera", name, on: shown }); };
      const toggle = RC.toggle(name, (shown) => { show(shown); toggle.blur(); }, on);
      this.cameras[name] = canvas;
      this.overlay.append(canvas);
      buttons.append(toggle);
      if (on) show(true);
    });
    return RC.section("Cameras", true, buttons);
  }

  // A pad turns drags of mouse or finger into displacements along two axes (down and right on the
  // screen are back and right for the operator).
  pad(text, kind, vertical, horizontal) {
    const knob = RC.element("i");
    const pad = RC.element("div", { className: "pad", ariaLabel: text }, RC.element("span", {}, text), knob);
    pad.dataset.pad = kind;
    let last = null;
    pad.addEventListener("pointerdown", (event) => { pad.setPointerCapture(event.pointerId); last = event; event.preventDefault(); });
    const end = () => { last = null; knob.style.left = knob.style.top = ""; };
    pad.addEventListener("pointerup", end);
    pad.addEventListener("pointercancel", end);
    pad.addEventListener("pointermove", (event) => {
      if (!last) return;
      const right = event.clientX - last.clientX, down = event.clientY - last.clientY;
      last = event;
      const box = pad.getBoundingClientRect();
      knob.style.left = `${Math.min(Math.max(event.clientX - box.left, 0), box.width)}px`;
      knob.style.top = `${Math.min(Math.max(event.clientY - box.top, 0), box.height)}px`;
      const rate = this.speed_ * (event.shiftKey ? 0.3 : 1);
      if (kind === "move" || kind === "lift") {
        this.drag[vertical] -= down * RC.METRES_PER_PIXEL * rate;
        if (horizontal !== null) this.drag[horizontal] -= right * RC.METRES_PER_PIXEL * rate;
      } else if (kind === "tilt") {
        this.turn[0] += right * RC.RADIANS_PER_PIXEL * rate;
        this.turn[1] -= down * RC.RADIANS_PER_PIXEL * rate;
      } else this.turn[2] -= right * RC.RADIANS_PER_PIXEL * rate;
    });
    return pad;
  }

  // The orientation of a phone turns the tool. Browsers give it to pages of https alone.
  phoneButton() {
    if (!window.isSecureContext || !window.DeviceOrientationEvent || !matchMedia("(pointer: coarse)").matches) return "";
    let before = null;
    const onTurn = (event) => {
      const now = RC.phoneRotation(event.alpha, event.beta, event.gamma);
      if (before) RC.phoneTurn(before, now).forEach((angle, axis) => (this.turn[axis] += angle));
      before = now;
    };
    return RC.toggle("Turn with the phone", async (on) => {
      before = null;
      if (!on) return removeEventListener("deviceorientation", onTurn);
      if (DeviceOrientationEvent.requestPermission && (await DeviceOrientationEvent.requestPermission()) !== "granted") return;
      addEventListener("deviceorientation", onTurn);
    });
  }

  onKey(event, down) {
    this.slow = event.shiftKey;
    // A key that is let go always counts, whatever else is held and wherever the focus is.
    if (!down && this.pressed.delete(event.code)) return event.preventDefault();
    if (event.ctrlKey || event.metaKey || event.altKey) {
      this.release(); // some systems tell nothing of keys that are let go meanwhile
      return;
    }
    if (event.target.matches?.("input[type=search], select")) return;
    if (event.code === "Space") {
      if (down && !event.repeat) { this.grip.set(this.opening !== 0); this.setOpening(this.opening === 0 ? 1 : 0); }
    } else if (RC.KEYS[event.code]) {
      if (down) { this.pressed.add(event.code); this.tapped.add(event.code); }
    } else if (RC.COMMAND_KEYS[event.code]) {
      if (!down || event.repeat) return;
      const name = RC.COMMAND_KEYS[event.code];
      this.command(name === "record" && this.phase === "review" ? "keep" : name);
    } else return;
    event.preventDefault();
  }

  release() {
    this.pressed.clear();
    this.tapped.clear();
  }

  // Leaves the gripper as it is until it is closed or opened.
  forgetOpening() { this.opening = null; this.grip.set(false); }

  setOpening(value) { this.opening = value; }

  command(name) { this.send({ op: "command", name }); }

  sendInput() {
    if (!this.drives || document.hidden) return;
    if (this.isStale()) { // nobody drives what he does not see
      this.release();
      this.drag = [0, 0, 0];
      this.turn = [0, 0, 0];
      return;
    }
    const input = { op: "input", linear: [0, 0, 0], angular: [0, 0, 0], drag: this.drag, turn: this.turn,
      opening: this.opening, clutch: this.clutch.classList.contains("on"), frame: this.frame };
    for (const key of new Set([...this.pressed, ...this.tapped])) {
      const [array, axis, sign] = RC.KEYS[key];
      input[array][axis] += sign * this.speed_ * (this.slow ? 0.3 : 1);
    }
    if (this.frame === "camera") {
      // Forward is where the view looks, on the floor.
      const angle = this.view.azimuth(), c = Math.cos(angle), s = Math.sin(angle);
      for (const name of ["linear", "angular", "drag", "turn"]) {
        const [x, y, z] = input[name];
        input[name] = [c * x - s * y, s * x + c * y, z];
      }
      input.frame = "world";
    }
    this.drag = [0, 0, 0];
    this.turn = [0, 0, 0];
    this.tapped.clear();
    this.send(input);
  }

  show(header, array) {
    const first = !this.streams;
    this.streams = header.streams;
    this.drives = header.drives;
    if (first) { this.build(); this.drive.hidden = !this.drives; }
    if (this.phase !== header.phase) {
      if (header.phase === "waiting") this.forgetOpening();
      this.phase = header.phase;
      document.documentElement.dataset.phase = this.phase;
    }
    const arms = header.arms || [];
    if (this.arm !== header.arm) {
      if (this.arm) this.forgetOpening(); // that of another arm
      this.arm = header.arm || "";
    }
    this.buttons.find((each) => each.dataset.command === "next_arm").hidden = arms.length < 2;
    super.show(header, array);
    for (const { name } of header.images) if (this.cameras[name]?.wanted) this.cameras[name].hidden = false;
    const [text, kind] = RC.BANNERS[header.phase];
    const more = header.phase === "countdown" ? ` ${Math.max(header.left_s, 0).toFixed(1)} s`
      : header.phase === "recording" ? `, ${header.rows} actions` : "";
    this.say(header.phase === "recording" && header.success ? "Success" : header.phase === "review" && header.success ? `Success. ${text}` : text + more,
      header.success ? "good" : kind);
    this.instruction.textContent = header.instruction || "";
    const notes = [`episode ${header.episode}`];
    if (arms.length > 1) notes.push(`arm ${header.arm} moves; T chooses the next of ${arms.join(", ")}`);
    if (header.dropped) notes.push(`the last episode was dropped: ${header.dropped}`);
    if (header.silent) notes.push("the device is silent: the arm holds");
    if (header.blocked) notes.push(`the arm stops: ${header.blocked}`);
    if (header.help) notes.push(header.help);
    this.state.textContent = notes.join(". ");
    const usable = { waiting: ["record", "reset_origin", "quit"], countdown: ["quit"], review: ["keep", "discard", "quit"],
      recording: ["success", "failure", "discard", "resync", "reset_origin", "next_arm", "quit"] }[header.phase];
    this.buttons.at(-1).title = header.phase === "review" ? "Q: keeps this episode" : "Q";
    for (const button of this.buttons) button.disabled = !usable.includes(button.dataset.command);
  }
};

RC.start.teleop = (app) => { RC.page = new RC.TeleopPage(app); };
