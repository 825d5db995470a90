// The list of a dataset's episodes with filters; a click opens the player.
"use strict";

RC.MOST_SHOWN = 500;

RC.start.dataset = async (app) => {
  app.classList.add("list");
  const { episodes, broken } = await (await RC.get("list")).json();
  const result = RC.element("select", { ariaLabel: "result" });
  for (const text of ["all results", "success", "failure"]) result.append(RC.element("option", { value: text }, text));
  const words = RC.element("input", { type: "search", placeholder: "id, instruction, object, reason", ariaLabel: "filter", size: 32 });
  const count = RC.element("span", { className: "note", role: "status" });
  const body = RC.element("tbody");
  const cell = (text, className = "") => RC.element("td", { className }, text);
  const show = () => {
    const parts = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = episodes.filter((each) => {
      if (result.value !== "all results" && each.success !== (result.value === "success")) return false;
      const text = [each.id, each.instruction, each.reason, ...each.objects].join(" ").toLowerCase();
      return parts.every((part) => text.includes(part));
    });
    body.replaceChildren(...found.slice(0, RC.MOST_SHOWN).map((each) => RC.element("tr", {},
      RC.element("td", {}, RC.element("a", { href: RC.address("", { episode: each.id }) }, each.id)),
      cell(each.success ? "success" : "failure", each.success ? "success" : "failure"),
      cell(each.success ? "" : each.reason), cell(String(each.rows)), cell(each.instruction), cell(each.objects.join(", ")))));
    const good = found.filter((each) => each.success).length;
    count.textContent = `${found.length} of ${episodes.length} episodes, ${good} successes` +
      (found.length > RC.MOST_SHOWN ? `; the first ${RC.MOST_SHOWN} are listed` : "") +
      (broken.length ? `; ${broken.length} broken, see robocell verify` : "");
  };
  result.addEventListener("change", show);
  words.addEventListener("input", show);
  const head = RC.element("tr", {}, ...["episode", "result", "reason", "rows", "instruction", "objects"].map((text) => RC.element("th", {}, text)));
  app.append(RC.element("h1", {}, document.title), RC.element("div", { className: "filters" }, result, words, count),
    RC.element("table", {}, RC.element("thead", {}, head), body));
  show();
  document.documentElement.dataset.loaded = "true";
};
