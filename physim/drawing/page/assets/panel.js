// Figures of the moment and the legend, beside the view; the words are those of the video.

import { button, el, say } from "./dom.js";
import { drawContact } from "./marks.js";
import { Fleet, nowAt } from "./robots.js";
import { decimal, metres } from "./words.js";

/** The table of figures, one column a run; `update` shows another time. */
export function figures(views) {
  const labels = ["contacts so far", "touching now", "closest now", "wall, closest now", "finished"];
  const cells = labels.map(() => views.map(() => el("td", {})));
  const many = views.length > 1;
  const top = many
    ? [el("thead", {}, el("tr", {}, el("td", {}), views.map(({ run }) => el("th", { scope: "col" }, run.label))))]
    : [];
  const rows = labels.map((label, k) => el("tr", {}, el("th", { scope: "row" }, label), cells[k]));
  const table = el("table", { class: "figures" }, el("caption", { class: "unseen" }, "Figures of this moment"), top, el("tbody", {}, rows));
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
  const touching = now.length ? both(now.at(-1).k) + (now.length > 1 ? ` + ${now.length - 1}` : "") : "none";
  const pair = view.closest(time);
  const closest = pair ? `${run.names[pair.a]} – ${run.names[pair.b]} ${metres(pair.distance)}` : "–";
  const walls = run.header.curves.wall ? (view.walls ??= run.array("now_wall")) : null;
  const wall = walls ? walls[nowAt(run, time)] : Infinity;
  const isKnown = run.header.contacts.recorded;
  return [
    [isKnown ? contacts.length ? `${count} of ${contacts.length}` : "none" : "not recorded", count > 0],
    [isKnown ? touching : "not recorded", now.length > 0],
    [closest, pair !== null && pair.distance <= 0],
    [Number.isFinite(wall) ? metres(wall) : "–", wall <= 0],
    [run.finished(time) ? "yes" : "no", false],
  ];
}

/** Legend: modes with how many robots have each now, and one line for every sign. */
export function legend(view, colours) {
  const { run } = view;
  const counts = new Map();
  const modes = run.header.explained.map((number) => {
    const mode = run.modes[number];
    const swatch = el("span", { class: "swatch" });
    swatch.style.setProperty("--mode", mode.colour);
    const count = el("span", { class: "count" });
    counts.set(number, count);
    return el("li", {}, swatch, el("span", {}, mode.words), count);
  });
  const signs = run.header.signs.map((words) =>
    el("li", {}, sign(words, colours), el("span", {}, words)),
  );
  const list = [
    el("h2", {}, modes.length ? `modes of ${run.header.why.controller}` : run.header.why.controller),
    el("ul", { class: "legend" }, modes),
    el("h2", {}, "signs"),
    el("ul", { class: "legend" }, signs),
  ];
  const update = (time) => {
    const now = new Map();
    for (const mode of run.modesAt(time)) now.set(mode, (now.get(mode) ?? 0) + 1);
    for (const [number, count] of counts) say(count, String(now.get(number) ?? 0));
  };
  return { list, update };
}

const BOX = new Float64Array([-8, -5, 8, -5, 8, 5, -8, 5]);

/** A small drawing of what some words of the legend stand for. */
function sign(words, colours) {
  const canvas = el("canvas", { width: 60, height: 40, "aria-hidden": "true" });
  const context = canvas.getContext("2d");
  context.setTransform(2, 0, 0, 2, 30, 20);
  const stroke = (colour, width, dash = []) => {
    context.setLineDash(dash);
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    context.moveTo(-12, 0);
    context.lineTo(12, 0);
    context.stroke();
    context.setLineDash([]);
  };
  const ring = (radius, fill, edge, x = 0) => {
    context.beginPath();
    context.arc(x, 0, radius, 0, 7);
    context.fillStyle = fill;
    if (fill) context.fill();
    context.strokeStyle = edge;
    context.lineWidth = 1.5;
    context.stroke();
  };
  const key = Object.entries({ "safe area": "safe", "danger area": "danger", "accessible area": "floor", obstacle: "obstacle" })
    .find(([name]) => name === words)?.[1];
  if (key) {
    context.fillStyle = colours[key];
    context.fillRect(-12, -6, 24, 12);
    context.strokeStyle = colours.quiet;
    context.lineWidth = 0.5;
    context.strokeRect(-12, -6, 24, 12);
  } else if (words === "contact") drawContact(context, 0, 0, {}, colours);
  else if (words.startsWith("too deep")) drawContact(context, 0, 0, { deep: true }, colours, true);
  else if (words.startsWith("contact between")) drawContact(context, 0, 0, { swept: true }, colours);
  else if (words === "a contact begins") ring(7, null, colours.contact);
  else if (words === "closest pair") {
    stroke(colours.ink, 2);
    for (const x of [-11, 11]) ring(2, colours.ink, colours.ink, x);
  } else if (words === "target") {
    stroke(colours.quiet, 1);
    ring(3, colours.paper, colours.ink, 9);
  } else if (words.startsWith("trail")) stroke(colours.robots[0], 2);
  else if (words.startsWith("path")) stroke(colours.robots[0], 1.2, words.includes("dashed") ? [9, 3, 3, 3] : []);
  else if (words.startsWith("reference")) stroke(colours.reference, 2);
  else if (words === "boundary") stroke(colours.wall, 3);
  else {
    const path = new Path2D();
    const corners = Fleet.placed(BOX, [0, 0, 0], 0, { scale: 1, x: 0, y: 0 });
    for (let k = 0; k < 8; k += 2) path.lineTo(corners[k], corners[k + 1]);
    context.fillStyle = colours.robots[0];
    context.fill(path);
  }
  return canvas;
}

/** What there is to see, as buttons: shortest distances and times, first and deepest contact. */
export function moments(view, go) {
  const items = view.run.header.moments.map(({ label, time, words, robot, contact }) =>
    el(
      "li", {},
      button(`${label}: ${words}`, () => go({ time, robot: robot ?? -1, contact: contact ?? -1 }), { class: "link" }),
    ),
  );
  return items.length ? [el("h2", {}, "moments"), el("ul", { class: "moments" }, items)] : [];
}

export const clock = (time) => `${decimal(time, 2)} s`;
