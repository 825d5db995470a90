// What all pages share: elements, requests with the token of the address, and the WebSocket.
"use strict";
RC.token = new URLSearchParams(location.search).get("token") || "";

RC.element = function (tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name in made && name !== "list") made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
};

RC.address = (path, query = {}) => path + "?" + new URLSearchParams({ token: RC.token, ...query });

// A page in one file has its data in it.
RC.embedded = function (path, query = {}) {
  const name = query.camera === undefined ? path : `${path}-${query.camera}`;
  const found = [...document.querySelectorAll("script[data-name]")].find((each) => each.dataset.name === name);
  if (!found) return null;
  const bytes = Uint8Array.from(atob(found.textContent), (each) => each.charCodeAt(0));
  return { arrayBuffer: async () => bytes.buffer };
};

RC.get = async function (path, query) {
  const own = RC.embedded(path, query);
  if (own) return own;
  const answer = await fetch(RC.address(path, query));
  if (!answer.ok) throw new Error(await answer.text());
  return answer;
};

RC.slider = function (label, { lower, upper, value = 0, step = "any", unit = "" }, onInput) {
  const input = RC.element("input", { type: "range", min: lower, max: upper, step, ariaLabel: label });
  const output = RC.element("output");
  const show = (number) => (output.textContent = `${Number(number).toFixed(3)} ${unit}`);
  input.value = value;
  show(value);
  input.addEventListener("input", () => { show(input.value); onInput(Number(input.value)); });
  const row = RC.element("div", { className: "row" }, RC.element("label", { title: label }, label), input, output);
  // A slider that the user holds is not moved by frames.
  row.set = (number) => { if (!input.matches(":active")) { input.value = number; show(number); } };
  return row;
};

RC.toggle = function (text, onChange, on = false) {
  const button = RC.element("button", { type: "button" }, text);
  button.set = (state) => { on = state; button.classList.toggle("on", on); button.ariaPressed = String(on); };
  button.addEventListener("click", () => { button.set(!on); onChange(on); });
  button.set(on);
  return button;
};

RC.section = function (title, open, ...children) {
  return RC.element("details", { open }, RC.element("summary", {}, title), ...children);
};

RC.viewSection = function (view) {
  const select = RC.element("select", { ariaLabel: "frames", onchange: () => view.show({ frames: select.value }) });
  for (const [value, text] of [["none", "no frames"], ["robot", "TCPs"], ["body", "bodies"], ["site", "sites"], ["camera", "cameras"]])
    select.append(RC.element("option", { value }, text));
  return RC.section("View", false,
    RC.element("div", { className: "buttons" }, select, RC.toggle("Collision geoms", (on) => view.show({ collision: on })),
      RC.element("button", { type: "button", onclick: () => { view.look(view.header); view.dirty = true; } }, "Home")),
    RC.element("p", { className: "note" }, "Drag turns, right drag moves, the wheel zooms. Two fingers move and zoom."));
};

// Draws pixels (height, width, 3) into a canvas.
RC.paint = function (canvas, place, rgb) {
  const [height, width] = place.shape;
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const image = new ImageData(width, height);
  for (let i = 0, j = 0; j < rgb.length; i += 4, j += 3) {
    image.data[i] = rgb[j];
    image.data[i + 1] = rgb[j + 1];
    image.data[i + 2] = rgb[j + 2];
    image.data[i + 3] = 255;
  }
  canvas.getContext("2d").putImageData(image, 0, 0);
};

// A connection that asks for one frame after the other. `onFrame` gets header and arrays, and
// `onState` whether the connection is open. A frame that fails is told to `onError`; others follow.
RC.Connection = class {
  constructor(onFrame, onState, onError) {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(`${scheme}//${location.host}/${RC.address("socket")}`);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => { onState(true); this.next(); };
    this.socket.onclose = (event) => onState(false, event.reason);
    this.socket.onmessage = async (event) => {
      try {
        if (event.data.byteLength) await onFrame(...RC.unpack(event.data));
      } catch (error) {
        onError(error);
        await new Promise((resolve) => setTimeout(resolve, 500)); // asks the server no faster
      }
      this.next();
    };
  }

  next() { this.send({ op: "next" }); }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
};

addEventListener("DOMContentLoaded", async () => {
  const app = document.getElementById("app");
  try {
    await RC.start[document.documentElement.dataset.kind](app);
  } catch (error) {
    app.append(RC.element("p", { className: "error" }, error.message));
  }
});
RC.start = {};

// A scene that stands still, in a page without a server.
RC.start.still = async (app) => {
  const box = RC.element("div", { className: "view" });
  const panel = RC.element("div", { className: "panel" }, RC.element("h1", {}, document.title));
  app.append(RC.element("div", { className: "stage" }, box), panel);
  const view = new RC.SceneView(box);
  view.load(await (await RC.get("geometry")).arrayBuffer());
  panel.append(RC.viewSection(view));
  document.documentElement.dataset.loaded = "true";
};
