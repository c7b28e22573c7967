// Figures of the moment and the legend, beside the view; the words are those of the video.

import { button, el, say } from "./dom.js";
import { disc, drawContact, line } from "./marks.js";
import { isFar, nowAt } from "./robots.js";
import { decimal, metres, seconds } from "./words.js";

/** The table of figures, one column a run; `update` shows another time. */
export function figures(views) {
  const labels = ["contacts so far", "touching now", "closest now", "wall, closest now", "finished"];
  const cells = labels.map(() => views.map(() => el("td", {})));
  const heads = views.map(({ run }) => el("th", { scope: "col" }, run.label));
  const table = el(
    "table", { class: "figures" },
    el("caption", { class: "unseen" }, "Figures of this moment"),
    views.length > 1 ? el("thead", {}, el("tr", {}, el("td", {}), heads)) : null,
    el("tbody", {}, labels.map((label, k) => el("tr", {}, el("th", { scope: "row" }, label), cells[k]))),
  );
  const update = (time) => {
    views.forEach((view, column) => {
      momentOf(view, Math.min(time, view.run.duration)).forEach(([words, isBad], k) => {
        say(cells[k][column], words);
        cells[k][column].classList.toggle("bad", isBad);
      });
    });
  };
  return { table, update };
}

function momentOf(view, time) {
  const { run, contacts } = view;
  const count = contacts.count(time);
  const now = contacts.shown(time).filter((one) => one.touches);
  const both = (k) => contacts.bodies(k).map((body) => run.names[body]).join(" – ");
  const graze = now.length && now.at(-1).swept ? " between samples" : ""; // apart at both
  const touching = now.length ? both(now.at(-1).k) + graze + (now.length > 1 ? ` + ${now.length - 1}` : "") : "none";
  const pair = view.closest(time);
  const closest = pair ? `${run.names[pair.a]} – ${run.names[pair.b]} ${metres(pair.distance)}` : "–";
  const sample = nowAt(run, time);
  const wall = run.header.curves.wall ? (view.walls ??= run.array("now_wall"))[sample] : Infinity;
  const when = isFar(run, sample, time) ? ` at ${seconds(run.now[sample] * run.dt)}` : "";
  const known = (words) => (run.header.contacts.recorded ? words : "not recorded");
  return [
    [known(contacts.length ? `${count} of ${contacts.length}` : "none"), count > 0],
    [known(touching), now.length > 0],
    [closest, pair !== null && pair.distance <= 0],
    [Number.isFinite(wall) ? metres(wall) + when : "–", wall <= 0],
    [run.finished(time) ? "yes" : "no", false],
  ];
}

/** Legend: modes with how many robots have each now, by controller where there are several, and one
 * line for every sign. */
export function legend(view, colours) {
  const { run } = view;
  const counts = [];
  const modesOf = (numbers, robots) =>
    el("ul", { class: "legend" }, numbers.map((number) => {
      const mode = run.modes[number];
      const swatch = el("span", { class: "swatch" });
      swatch.style.setProperty("--mode", mode.colour);
      const count = el("span", { class: "count" });
      counts.push({ number, robots, count });
      return el("li", {}, swatch, el("span", {}, mode.words), count);
    }));
  const { drivers, explained, why } = run.header;
  const groups = drivers.flatMap(({ words, modes, robots }) =>
    [el("h2", {}, words), modesOf(modes, robots)]);
  if (!drivers.length) {
    groups.push(el("h2", {}, explained.length ? `modes of ${why.controller}` : why.controller));
    groups.push(modesOf(explained, null));
  }
  const signs = run.header.signs.map((words) =>
    el("li", {}, sign(words, colours), el("span", {}, words)),
  );
  const list = [...groups, el("h2", {}, "signs"), el("ul", { class: "legend" }, signs)];
  const update = (time) => {
    const now = run.modesAt(time);
    for (const { number, robots, count } of counts) {
      const theirs = robots ? robots.map((robot) => now[robot]) : [...now];
      say(count, String(theirs.filter((mode) => mode === number).length));
    }
  };
  return { list, update };
}

const robot = (context, colour) => {
  context.fillStyle = colour;
  context.fillRect(-8, -5, 16, 10);
};

const across = (context, colour, width, dash = []) => {
  context.setLineDash(dash);
  line(context, [-12, 0], [12, 0], colour, width);
  context.setLineDash([]);
};
const area = (key) => (context, colours) => {
  Object.assign(context, { fillStyle: colours[key], strokeStyle: colours.quiet, lineWidth: 0.5 });
  context.fillRect(-12, -6, 24, 12);
  context.strokeRect(-12, -6, 24, 12);
};
/** By the first words of a line of the legend: how a small drawing of it is made. */
const SIGNS = [
  ["safe area", area("safe")],
  ["danger area", area("danger")],
  ["accessible area", area("floor")],
  ["obstacle", area("obstacle")],
  ["contact between", (context, colours) => drawContact(context, 0, 0, { swept: true }, colours)],
  ["contact", (context, colours) => drawContact(context, 0, 0, {}, colours)],
  ["too deep", (context, colours) => drawContact(context, 0, 0, { deep: true }, colours, true)],
  ["a contact begins", (context, colours) => disc(context, 0, 0, 7, null, colours.contact, 1.5)],
  ["closest pair", (context, colours) => {
    across(context, colours.ink, 2);
    for (const x of [-11, 11]) disc(context, x, 0, 2.5, colours.ink);
  }],
  ["mover", (context, colours) => {
    robot(context, colours.mover);
    Object.assign(context, { strokeStyle: colours.wall, lineWidth: 1.5 });
    context.strokeRect(-8, -5, 16, 10);
  }],
  ["way", (context, colours) => across(context, colours.way, 1.5, [3, 4])],
  ["target", (context, colours) => {
    across(context, colours.quiet, 1);
    disc(context, 9, 0, 3, colours.paper, colours.ink, 1.5);
  }],
  ["trail", (context, colours) => across(context, colours.robots[0], 2)],
  ["path", (context, colours, words) => across(context, colours.robots[0], 1.2, words.includes("dashed") ? [9, 3, 3, 3] : [])],
  ["reference", (context, colours) => across(context, colours.reference, 2)],
  ["boundary", (context, colours) => across(context, colours.wall, 3)],
  ["robot without", (context, colours) => robot(context, colours.undecided)],
  ["", (context, colours) => robot(context, colours.robots[0])],
];

/** A small drawing of what some words of the legend stand for. */
function sign(words, colours) {
  const canvas = el("canvas", { width: 60, height: 40, "aria-hidden": "true" });
  const context = canvas.getContext("2d");
  context.setTransform(2, 0, 0, 2, 30, 20);
  SIGNS.find(([start]) => words.startsWith(start))[1](context, colours, words);
  return canvas;
}

/** What there is to see, as buttons: shortest distances and times, first and deepest contact. */
export function moments(view, begin, go) {
  const shown = view.run.header.moments.filter(({ time }) => time >= begin);
  const items = shown.map(({ label, time, words, robot, contact }) =>
    el(
      "li", {},
      button(`${label}: ${words}`, () => go({ time, robot: robot ?? -1, contact: contact ?? -1 }), { class: "link" }),
    ),
  );
  return items.length ? [el("h2", {}, "moments"), el("ul", { class: "moments" }, items)] : [];
}

export const clock = (time) => `${decimal(time, 2)} s`;
