// What happens to one robot in the whole run, in a sentence and as buttons that lead there.

import { button, el } from "./dom.js";
import { decimal, metres, plural } from "./words.js";

const MOST = 60;
const OPEN = 12; // events up to which the list is open from the start

/** The story of a robot; `go` is called with what to show. */
export function story(view, robot, go) {
  const { run } = view;
  const events = [...dangers(run, robot), ...contacts(view, robot), ...closest(run, robot), ...stands(run, robot)];
  const arrived = run.arrivedStep[robot];
  if (arrived >= 0) events.push({ time: arrived * run.dt, words: `${at(arrived * run.dt)}: arrives at its stop` });
  events.sort((a, b) => a.time - b.time);
  const items = events.slice(0, MOST).map((event) =>
    el("li", {}, button(event.words, () => go({ contact: -1, time: event.time, ...event.go }), { class: "link" })),
  );
  if (events.length > MOST) items.push(el("li", {}, `and ${events.length - MOST} more`));
  return el(
    "details", { class: "story", open: events.length <= OPEN },
    el("summary", {}, summary(view, robot, events)), el("ul", { class: "moments" }, items),
  );
}

const at = (time) => `${decimal(time, 2)} s`;

/** "r7 in this run: 3 times in danger, 4.2 s in all; no contact; arrives at 247.30 s" */
function summary(view, robot, events) {
  const { run } = view;
  const parts = [];
  if (run.modes.some((mode) => mode.danger)) {
    const found = dangers(run, robot);
    const long = found.reduce((sum, one) => sum + one.lasts, 0);
    parts.push(found.length ? `${plural(found.length, "time")} in danger, ${decimal(long, 1)} s in all` : "never in danger");
  }
  if (run.header.contacts.recorded) {
    const count = events.filter((one) => one.go).length;
    parts.push(count ? plural(count, "contact") : "no contact");
  }
  const arrived = run.arrivedStep[robot];
  parts.push(arrived < 0 ? "does not arrive" : `arrives at ${at(arrived * run.dt)}`);
  return `${run.names[robot]} in this run: ${parts.join("; ")}`;
}

/** Times in danger from its begin to its end, whichever modes of danger it goes through. */
function dangers(run, robot) {
  const found = [];
  for (const [from, to, mode] of run.spans(robot)) {
    if (mode < 0 || !run.modes[mode].danger) continue;
    const last = found.at(-1);
    if (last?.to === from) {
      last.to = to;
      last.modes.add(mode);
    } else found.push({ from, to, modes: new Set([mode]) });
  }
  return found.map(({ from, to, modes }) => {
    const words = [...modes].map((mode) => run.modes[mode].words).join("; ");
    return { time: from, lasts: to - from, words: `${at(from)} to ${at(to)}: ${words}` };
  });
}

function contacts({ run, contacts: all }, robot) {
  return all.of(robot).map((k) => {
    const other = all.bodies(k).find((body) => body !== robot);
    return { time: all.time(k), words: `${at(all.time(k))}: contact with ${run.names[other]}`, go: { contact: k } };
  });
}

function closest(run, robot) {
  const found = [];
  for (const name of ["near", "near_wall"]) {
    const [step, body] = ["step", "body"].map((part) => run.array.whole(`${name}_${part}`)[robot]);
    if (step < 0) continue;
    const time = step * run.dt;
    const away = metres(run.array(name)[robot]);
    found.push({ time, words: `${at(time)}: closest to ${{ robot: "a robot", mover: "a mover" }[run.kind(body)] ?? (name === "near" ? "an obstacle" : "a wall")}, ${run.names[body]}: ${away}` });
  }
  return found;
}

function stands(run, robot) {
  const [robots, from, to] = ["robot", "from", "to"].map((part) => run.array.whole(`stand_${part}`));
  const found = [];
  for (let k = 0; k < robots.length; k++) {
    if (robots[k] !== robot) continue;
    found.push({ time: from[k] * run.dt, words: `${at(from[k] * run.dt)} to ${at(to[k] * run.dt)}: stands still` });
  }
  return found;
}
