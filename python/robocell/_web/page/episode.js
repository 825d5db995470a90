// The player of an episode: scrub, play, phases, videos and plots beside the picture.
"use strict";

RC.COLOURS = ["#1f6feb", "#d1495b", "#2e8b57", "#b7791f", "#7b4fb5", "#1a8fa3", "#8a5a44", "#57636f"];

RC.Player = class {
  constructor(app, data, query) {
    [this.header, this.array] = RC.unpack(data);
    this.query = query;
    this.times = this.array(this.header.times);
    this.poses = this.header.poses && this.array(this.header.poses);
    this.points = this.header.points && this.array(this.header.points);
    this.row = 0;
    this.time = 0;
    this.playing = false;
    this.plotted = new Set();
    this.videos = [];
    this.box = RC.element("div", { className: "view" });
    const stage = RC.element("div", { className: "stage" }, this.box, this.strip(), this.phases(), this.scrub(), this.plots());
    this.panel = RC.element("div", { className: "panel" });
    app.append(stage, this.panel);
  }

  async load(get) {
    if (this.poses) {
      this.view = new RC.SceneView(this.box);
      this.view.load(await get("geometry"));
      this.stride = this.poses.length / this.times.length;
    } else {
      this.box.append(RC.element("p", { className: "banner" }, `No 3D view: ${this.header.without_poses}`));
    }
    const { id, success, reason, instruction, columns } = this.header;
    this.panel.append(
      RC.element("h1", {}, id),
      RC.element("p", { className: success ? "success" : "failure" }, success ? "success" : `failure: ${reason}`),
      RC.element("p", {}, instruction),
      ...(this.view ? [RC.viewSection(this.view)] : []),
      RC.section("Plots", true, ...columns.map((column) => RC.element("div", {}, RC.toggle(column.name, (on) => this.plot(column, on))))));
    for (const name of this.header.cameras) {
      const bytes = await get("video", { camera: name });
      const video = RC.element("video", { muted: true, preload: "auto", ariaLabel: name });
      video.src = URL.createObjectURL(new Blob([bytes], { type: "video/mp4" }));
      this.videos.push(video);
      this.strip_.append(RC.element("figure", {}, video, RC.element("figcaption", { className: "note" }, name)));
      video.addEventListener("loadedmetadata", () => this.seek(video));
    }
    this.strip_.hidden = !this.videos.length;
    const first = columns.find((column) => column.name.endsWith("/qpos")) || columns[0];
    if (first) [...this.panel.querySelectorAll("button")].find((each) => each.textContent === first.name).click();
    this.show(0);
    let before = performance.now();
    const tick = (now) => {
      requestAnimationFrame(tick);
      if (this.playing) this.advance((now - before) / 1000);
      before = now;
    };
    requestAnimationFrame(tick);
    document.documentElement.dataset.loaded = "true";
  }

  strip() {
    this.strip_ = RC.element("div", { className: "videos", hidden: true });
    return this.strip_;
  }

  phases() {
    const bar = RC.element("div", { className: "phases", hidden: !this.header.phases.length });
    const last = Math.max(this.times.length - 1, 1);
    this.header.phases.forEach((phase, i) => {
      const end = this.header.phases[i + 1]?.first ?? last;
      const span = RC.element("span", { title: phase.name }, phase.name);
      span.style.left = `${(100 * phase.first) / last}%`;
      span.style.width = `${(100 * (end - phase.first)) / last}%`;
      span.style.background = RC.COLOURS[i % RC.COLOURS.length];
      bar.append(span);
    });
    return bar;
  }

  scrub() {
    const last = this.times.length - 1;
    this.button = RC.toggle("Play", (on) => this.play(on));
    this.slider = RC.element("input", { type: "range", min: 0, max: last, step: 1, ariaLabel: "row" });
    this.slider.addEventListener("input", () => { this.play(false); this.show(Number(this.slider.value)); });
    this.text = RC.element("output");
    addEventListener("keydown", (event) => {
      if (event.target.matches("input, select") && event.target !== this.slider) return;
      const by = { ArrowLeft: -1, ArrowRight: 1, Home: -1e9, End: 1e9 }[event.key];
      if (event.key === " ") this.play(!this.playing);
      else if (by === undefined) return;
      else { this.play(false); this.show(this.row + by); }
      event.preventDefault();
    });
    return RC.element("div", { className: "scrub" }, this.button, this.slider, this.text);
  }

  plots() {
    this.plotBox = RC.element("div", { className: "plots", hidden: true });
    return this.plotBox;
  }

  play(on) {
    if (on && this.row === this.times.length - 1) this.show(0);
    this.playing = on;
    this.button.set(on);
  }

  advance(seconds) {
    this.time += seconds;
    let row = this.row;
    while (row + 1 < this.times.length && this.times[row + 1] <= this.time) ++row;
    if (row !== this.row) this.show(row, this.time);
    if (row === this.times.length - 1) this.play(false);
  }

  show(row, time) {
    this.row = Math.min(Math.max(row, 0), this.times.length - 1);
    this.time = time ?? this.times[this.row];
    if (this.view) {
      this.view.setPoses(this.poses.subarray(this.row * this.stride, (this.row + 1) * this.stride));
      const size = this.points.length / this.times.length;
      this.view.setPoints(this.points.subarray(this.row * size, (this.row + 1) * size));
    }
    this.slider.value = this.row;
    const phase = this.header.phases.filter((each) => each.first <= this.row).pop();
    this.text.textContent = `row ${this.row} of ${this.times.length - 1}, ${this.times[this.row].toFixed(2)} s${phase ? `, ${phase.name}` : ""}`;
    this.videos.forEach((video) => this.seek(video));
    this.drawPlots();
    document.documentElement.dataset.row = this.row;
  }

  // Frame i of a video belongs to row i; half a frame later is safely inside it.
  seek(video) {
    if (Number.isFinite(video.duration)) video.currentTime = ((this.row + 0.5) * video.duration) / this.times.length;
  }

  plot(column, on) {
    if (on) this.plotted.add(column);
    else this.plotted.delete(column);
    this.plotBox.hidden = !this.plotted.size;
    this.plotBox.replaceChildren();
    for (const each of this.plotted) {
      const canvas = RC.element("canvas", { ariaLabel: each.name, onclick: (event) => {
        this.play(false);
        this.show(Math.round((event.offsetX / canvas.clientWidth) * (this.times.length - 1)));
      } });
      canvas.column = each;
      this.plotBox.append(canvas);
    }
    this.drawPlots();
  }

  drawPlots() {
    for (const canvas of this.plotBox.children) {
      const { column } = canvas;
      const values = this.array(column.values), size = column.values.shape[1], rows = column.values.shape[0];
      const width = (canvas.width = canvas.clientWidth * devicePixelRatio), height = (canvas.height = canvas.clientHeight * devicePixelRatio);
      const pen = canvas.getContext("2d");
      let low = Infinity, high = -Infinity;
      for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
      if (high - low < 1e-9) { low -= 0.5; high += 0.5; }
      const top = 20 * devicePixelRatio;
      const x = (row) => (row / Math.max(rows - 1, 1)) * (width - 1);
      const y = (value) => height - 4 - ((value - low) / (high - low)) * (height - top - 8);
      for (let i = 0; i < size; ++i) {
        pen.strokeStyle = RC.COLOURS[i % RC.COLOURS.length];
        pen.lineWidth = 1.5 * devicePixelRatio;
        pen.beginPath();
        for (let row = 0; row < rows; ++row) pen.lineTo(x(row), y(values[row * size + i]));
        pen.stroke();
      }
      pen.strokeStyle = "#1d2733";
      pen.lineWidth = devicePixelRatio;
      pen.beginPath();
      pen.moveTo(x(this.row), top);
      pen.lineTo(x(this.row), height);
      pen.stroke();
      pen.font = `${12 * devicePixelRatio}px sans-serif`;
      pen.fillStyle = "#1d2733";
      const now = Array.from({ length: Math.min(size, 8) }, (_, i) => values[this.row * size + i].toFixed(3)).join("  ");
      pen.fillText(`${column.name} [${column.units}]   ${low.toFixed(2)} ... ${high.toFixed(2)}   now ${now}`, 4, 14 * devicePixelRatio);
    }
  }
};

RC.start.episode = async (app) => {
  const episode = new URLSearchParams(location.search).get("episode");
  const query = episode ? { episode } : {};
  const get = async (path, more) => (await RC.get(path, { ...query, ...more })).arrayBuffer();
  RC.page = new RC.Player(app, await get("episode"), query);
  await RC.page.load(get);
};
