// Puts the page together: reads the runs, shows a moment of them, and follows what the reader does.

import { agree } from "./camera.js";
import { DASHED } from "./courses.js";
import { unpack } from "./decode.js";
import { button, byId, el, say } from "./dom.js";
import { readHash, writeHash } from "./hash.js";
import { KEYS, listenToKeys } from "./keys.js";
import { clock, figures, legend, moments } from "./panel.js";
import { Player } from "./player.js";
import { Plots } from "./plots.js";
import { listen } from "./pointer.js";
import { Run } from "./run.js";
import { View } from "./view.js";
import { whyContact, whyRobot } from "./why.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 32];
const HIDDEN = 120; // [px] of the view that is left where the page was scrolled away from it
const USUAL = 60; // [s] of the reader's time that a run takes at most, as it opens

/** What robots cannot go through, as text: the same of runs that may be shown in one view. */
const solid = ({ header: { scene } }) => JSON.stringify([scene.walls, scene.obstacles]);

class Page {
  constructor(runs, schemes) {
    Object.assign(this, { runs, schemes });
    this.active = 0;
    this.robot = -1;
    this.contact = -1;
    this.layers = { names: true, targets: true, trails: true };
    this.ready = false;
    this.begin = Math.max(...runs.map((run) => run.begin));
    this.duration = Math.max(...runs.map((run) => run.duration));
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    const speed = SPEEDS.find((one) => (this.duration - this.begin) / one <= USUAL) ?? SPEEDS.at(-1);
    this.player = new Player(this.begin, this.duration, Math.max(1, speed), (time) => this.show(time));
    this.views = runs.map((run) => this.makeView(run));
    agree(this.views.map((view) => view.camera));
    this.plots = new Plots(byId("plots"), runs, this.begin, this.duration, (time) => this.player.seek(time));
    this.build();
    this.listen();
  }

  get scheme() {
    return this.dark.matches ? "dark" : "light";
  }

  get view() {
    return this.views[this.active];
  }

  makeView(run) {
    const canvas = el("canvas", {
      role: "img", tabindex: "0",
      "aria-label": `${run.label}: ${run.robots} robots from above. The tables below say what happened.`,
    });
    const title = el("h2", { class: "title" }, run.label);
    const over = el("p", { class: "over", hidden: "" }, `ended at ${run.duration.toFixed(1)} s, last picture`);
    const box = el("div", { class: "view" }, this.runs.length > 1 ? [title, over] : null, canvas);
    byId("views").append(box);
    const view = new View(run, canvas);
    Object.assign(view, { box, title, over });
    listen(view, {
      time: () => Math.min(this.player.time, run.duration),
      redraw: (moved) => this.redraw(moved),
      choose: (chosen, what) => this.go({ run: this.views.indexOf(chosen), robot: -1, contact: -1, ...what }),
    });
    return view;
  }

  /** Shows what was looked at otherwise, in all views alike. */
  redraw(moved) {
    for (const view of this.views) if (view !== moved) view.camera.copy(moved.camera);
    this.player.draw();
  }

  build() {
    const { player } = this;
    this.figures = figures(this.views);
    byId("figures").append(this.figures.table);
    this.speed = el(
      "select", { "aria-label": "speed", change: () => player.setSpeed(Number(this.speed.value)) },
      SPEEDS.map((speed) => el("option", { value: speed }, `×${speed}`)),
    );
    const looks = [["whole", "all of the scene"], ["robots", "all robots"]];
    const robots = this.runs[0].names.slice(0, Math.min(this.runs[0].robots, 200));
    this.looks = el(
      "select", { "aria-label": "follow", change: () => this.look(this.looks.value) },
      [...looks, ...robots.map((name, k) => [k, name])].map(([value, words]) => el("option", { value }, words)),
    );
    this.playing = button("▶", () => player.toggle(), { class: "play", "aria-label": "play" });
    byId("controls").append(
      this.playing,
      button("|◀", () => player.seek(0), { "aria-label": "to the start" }),
      button("−0.1 s", () => player.seek(player.time - 0.1), { "aria-label": "0.1 s back" }),
      button("+0.1 s", () => player.seek(player.time + 0.1), { "aria-label": "0.1 s on" }),
      el("label", {}, "speed ", this.speed),
      el("label", {}, "follow ", this.looks),
      button("+", () => this.zoom(1.25), { "aria-label": "closer" }),
      button("−", () => this.zoom(0.8), { "aria-label": "farther" }),
      ...Object.keys(this.layers).map((layer) => this.toggle(layer)),
      ...(this.runs.length > 1 ? [this.ghostBox()] : []),
    );
    this.looks.value = "robots";
    byId("keys").append(
      el("table", {}, el("caption", { class: "unseen" }, "Keys"), el("tbody", {}, KEYS.map(([key, does]) =>
        el("tr", {}, el("th", { scope: "row" }, key), el("td", {}, does))))),
    );
    const exact = Math.max(...this.runs.map((run) => run.header.tolerance)) * 1000;
    byId("keys").append(
      el("p", { class: "quiet" }, `Robots are drawn within ${exact} mm of their recorded positions.`),
    );
    this.scrub = byId("scrub");
    this.scrub.min = String(this.begin);
    this.scrub.max = String(this.duration);
    this.scrub.step = String(Math.max(this.runs[0].dt, 0.01));
    this.follow();
    this.refresh();
  }

  toggle(layer) {
    const box = el("input", {
      type: "checkbox", checked: true,
      change: () => {
        this.layers[layer] = box.checked;
        this.player.draw();
      },
    });
    return el("label", {}, box, layer);
  }

  ghostBox() {
    const box = el("input", { type: "checkbox", id: "ghosts", change: () => this.setGhosts(box.checked) });
    box.disabled = new Set(this.runs.map(solid)).size > 1;
    return el("label", {}, box, box.disabled ? "in one view (not these: their walls differ)" : "in one view");
  }

  /** Shows all runs in the first view, the others as outlines; or side by side. */
  setGhosts(together) {
    const [first, ...others] = this.views;
    first.ghosts = together ? others : [];
    const outlines = others.map(({ run }, k) => {
      const ends = run.duration < this.duration ? `, ends at ${run.duration.toFixed(1)} s` : "";
      return `${DASHED[k + 1]} outlines: ${run.label}${ends}`;
    });
    say(first.title, together ? [first.run.label, ...outlines].join("; ") : first.run.label);
    for (const view of others) view.box.hidden = together;
    if (together) this.go({ run: 0 });
    this.player.draw();
  }

  listen() {
    const { player } = this;
    this.scrub.addEventListener("input", () => player.seek(Number(this.scrub.value)));
    player.onChange(() => this.follow());
    this.dark.addEventListener("change", () => this.refresh());
    addEventListener("resize", () => player.draw());
    new ResizeObserver(() => player.draw()).observe(byId("views"));
    addEventListener("hashchange", () => this.go(readHash(location.hash, this.runs), false));
    listenToKeys({
      toggle: () => player.toggle(),
      step: (by) => player.seek(player.time + by),
      seek: (time) => player.seek(time === Infinity ? this.duration : time),
      faster: (by) => this.faster(by),
      zoom: (factor) => this.zoom(factor),
      look: () => this.look("robots"),
      next: (by) => this.next(by),
      follow: () => this.look(this.robot >= 0 ? this.robot : "robots"),
      choose: () => this.go({ robot: -1, contact: -1 }),
    });
  }

  faster(by) {
    const at = SPEEDS.findLastIndex((speed) => speed <= this.player.speed) + by;
    this.player.setSpeed(SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)]);
  }

  zoom(factor) {
    const { camera } = this.view;
    camera.zoomAt(factor, camera.size.map((pixels) => pixels / 2), this.player.time);
    this.redraw(this.view);
  }

  look(what, close = false) {
    const follow = what === "whole" || what === "robots" ? what : Number(what);
    for (const view of this.views) view.camera.look(follow, close);
    const isListed = [...this.looks.options].some((one) => one.value === String(what));
    if (!isListed) this.looks.append(el("option", { value: what }, this.view.run.names[what]));
    this.looks.value = String(what);
    this.player.draw();
  }

  next(by) {
    const { robots } = this.view.run;
    this.go({ robot: (Math.max(this.robot, by > 0 ? -1 : 0) + by + robots) % robots, contact: -1 });
  }

  /** Shows a moment, robot or contact; what is not given stays. */
  go({ time, run, robot, contact }, isNew = true) {
    if (run !== undefined && run !== this.active) {
      this.active = run;
      this.robot = -1;
      this.contact = -1;
    }
    if (robot !== undefined) this.robot = robot;
    if (contact !== undefined) this.contact = contact;
    if (time !== undefined) {
      this.player.pause();
      this.player.seek(time);
      if (contact >= 0) this.look(Math.min(...this.view.contacts.bodies(contact)), true);
      if (byId("views").getBoundingClientRect().bottom < HIDDEN) byId("views").scrollIntoView();
    }
    if (isNew) this.writeHash();
    this.refresh();
  }

  writeHash() {
    if (!this.ready) return; // the address is still to be read
    const { time } = this.player;
    const hash = writeHash({ time, run: this.active, robot: this.robot, contact: this.contact }, this.runs);
    try {
      history.replaceState(null, "", hash);
    } catch {
      // a page inside another may have no address
    }
  }

  /** What depends on the chosen run and the colours. */
  refresh() {
    this.colours = this.schemes[this.scheme];
    this.legend = legend(this.view, this.colours);
    byId("legend").replaceChildren(...this.legend.list);
    byId("moments").replaceChildren(...moments(this.view, this.begin, (what) => this.go(what)));
    this.views.forEach((view, k) => view.box.classList.toggle("active", this.views.length > 1 && k === this.active));
    this.whyKey = null;
    this.player.draw();
  }

  /** What depends on whether it plays, and how fast. */
  follow() {
    const { player } = this;
    say(this.playing, player.playing ? "❚❚" : "▶");
    this.playing.setAttribute("aria-label", player.playing ? "stop" : "play");
    this.speed.value = String(player.speed);
    if (!player.playing) this.writeHash();
  }

  show(time) {
    const { colours, layers } = this;
    this.views.forEach((view, k) => {
      if (view.box.hidden) return;
      const chosen = k === this.active ? this.robot : -1;
      const speed = this.player.speed;
      view.draw(time, { colours, speed, chosen, layers });
      view.over.hidden = time <= view.run.duration || time >= this.duration;
      view.box.classList.toggle("held", !view.over.hidden);
    });
    this.plots.draw(time, { colours, scheme: this.scheme, active: this.active, chosen: this.robot });
    this.figures.update(time);
    this.legend.update(Math.min(time, this.view.run.duration));
    this.scrub.value = String(time);
    this.scrub.setAttribute("aria-valuetext", clock(time));
    say(byId("clock"), clock(time));
    this.showWhy(Math.min(time, this.view.run.duration));
  }

  /** All robots of the run by name, for those who do not click into the view. */
  chooser() {
    const { names, robots } = this.view.run;
    const options = names.slice(0, robots).map((name, k) => el("option", { value: k }, name));
    const box = el(
      "select", { "aria-label": "robot to ask why", change: () => this.go({ robot: Number(box.value) }) },
      el("option", { value: -1 }, "a robot"), options,
    );
    return box;
  }

  /** The panel of the chosen contact or robot; made anew only when it says something else. */
  showWhy(time) {
    const { run } = this.view;
    const row = this.robot >= 0 ? run.decision(this.robot, time) : -1;
    const key = `${this.active} ${this.contact} ${this.robot} ${row}`;
    if (key === this.whyKey) return;
    this.whyKey = key;
    const go = (what) => this.go(what);
    const found = this.contact >= 0
      ? whyContact(this.view, this.contact, go)
      : this.robot >= 0 ? whyRobot(this.view, this.robot, time, go) : null;
    const box = byId("why");
    box.hidden = false;
    if (!found) {
      const hint = "Click a robot or the cross of a contact to see why it happened, or choose ";
      box.replaceChildren(el("p", { class: "hint" }, hint, this.chooser()));
      return;
    }
    const follow = this.contact < 0 ? button("follow", () => this.look(this.robot)) : null;
    const close = button("close", () => this.go({ robot: -1, contact: -1 }));
    box.replaceChildren(el("p", { class: "tools" }, follow, close), ...found.filter(Boolean));
  }
}

async function start() {
  const state = byId("state");
  try {
    if (typeof DecompressionStream === "undefined") {
      throw new Error("this browser is too old for it (it knows no DecompressionStream)");
    }
    if (!document.createElement("canvas").getContext("2d")) {
      throw new Error("this browser draws no canvas");
    }
    const blocks = [...document.querySelectorAll("script.run")];
    const labels = JSON.parse(byId("labels").textContent);
    const runs = await Promise.all(blocks.map(async (block, k) => {
      const run = new Run(await unpack(block.textContent), k);
      run.label = labels[k];
      return run;
    }));
    byId("app").hidden = false;
    const page = new Page(runs, JSON.parse(byId("schemes").textContent));
    page.go(readHash(location.hash || document.querySelector(".worst")?.hash || "", runs), false);
    page.ready = true;
    window.physim = page;
    state.remove();
  } catch (error) {
    byId("app").hidden = true;
    state.className = "fault";
    say(state, `The run cannot be shown: ${error.message}. The tables below have the results.`);
  }
}

start();
