// Why a robot does what it does: its last decision in words, what it saw, and the thresholds then.

import { button, el } from "./dom.js";
import { story } from "./events.js";
import { closestPoints } from "./robots.js";
import { amount, command, decimal, metres, plural, seconds } from "./words.js";

const SEEN = {
  distance: "nearest robot it considered",
  boundary_distance: "nearest wall",
  collision_time: "collision time",
};
const PLACES = ["target_x", "target_y"]; // told as the target
const MOST_OTHERS = 24;
const MOST_LOOKED_AT = 60;

/** The panel of one robot; `go` is called with what to show instead: {time, robot, contact}. */
export function whyRobot(view, robot, time, go) {
  const { run } = view;
  const row = run.decision(robot, time);
  const name = run.names[robot];
  if (row < 0) {
    return [head(name, null), el("p", {}, `${name} has not decided anything yet.`), story(view, robot, go)];
  }
  const mode = run.mode[row] < 0 ? null : run.modes[run.mode[row]];
  const rule = run.header.why.rules[run.rule[row]] ?? null;
  return [
    head(name, mode),
    el("p", { class: "because" }, because(view, robot, row, mode, rule)),
    rule ? ruleLine(rule) : null,
    seenTable(run, row, mode),
    story(view, robot, go),
    factTable(run, robot, row, go, time),
  ];
}

const caption = (words) => el("caption", { class: "unseen" }, words);

function head(name, mode) {
  const chip = mode && el("span", { class: "chip" }, mode.words);
  if (chip) chip.style.setProperty("--mode", mode.colour);
  return el("h2", {}, name, " ", chip);
}

function ruleLine(rule) {
  return el("p", { class: "rule" }, el("strong", {}, rule.words), rule.prose ? `: ${rule.prose}` : "");
}

/** One or two sentences: what made it decide as it did. */
export function because(view, robot, row, mode, rule) {
  const { run } = view;
  const at = `At ${decimal(run.step[row] * run.dt, 2)} s ${run.names[robot]}`;
  const [v, omega] = ["nominal_v", "nominal_omega"].map((column) => run.column(column)[row]);
  const does = `${at} decided to ${motion(v, omega)}`;
  const states = limits(run, row);
  if (!states.length || !mode) return `${does}${run.header.why.avoids ? "" : "; its avoidance is off"}.`;
  if (mode.danger) {
    const near = states.filter((one) => one.isShort && one.column !== "collision_time")
      .map((one) => told(one, one.column === "distance" ? nearest(view, robot, row) : ""));
    const time = states.find((one) => one.column === "collision_time");
    if (!near.length && time) {
      const until = time.wasDanger ? "no later than" : "in less than";
      near.push(
        `by the command it would take in safe mode it would touch a robot or wall ${until} ` +
          `${seconds(time.limit)} from then`,
      );
    }
    if (!states[0].wasDanger) return `${does}, because ${near.join(" and ")}.`;
    const clear = states.map(({ column, limit }) => `${SEEN[column]} above ${amount(limit, column === "collision_time" ? "s" : "m")}`);
    return `${does}. It stays in danger until all are clear (${clear.join(", ")}): ${near.join(" and ")}.`;
  }
  if (rule?.name === "stop") return `${at} stands at its stop.`;
  const seen = states.filter((one) => !Number.isNaN(one.value));
  if (!seen.length) return `${does}.`;
  return `${does}; nothing was near: ${seen.map((one) => `${SEEN[one.column]} ${saw(run, one)}`).join(", ")}.`;
}

/** A command as people say it. */
function motion(v, omega) {
  [v, omega] = [v, omega].map((one) => (Math.abs(one) < 5e-3 ? 0 : one)); // as they are shown
  if (!v && !omega) return "stand still";
  const turn = !omega ? "straight" : omega > 0 ? "turning left" : "turning right";
  if (!v) return `turn ${omega > 0 ? "left" : "right"} where it stands`;
  const on = turn === "straight" ? "" : `, ${turn}`;
  return `${v > 0 ? `drive at ${decimal(v, 2)} m/s` : `back up at ${decimal(-v, 2)} m/s`}${on || " straight on"}`;
}

function told({ column, value, enter, leave }, who) {
  const [near, any] = column === "distance"
    ? [`the nearest robot it considered${who && `, ${who},`}`, `a robot it considered${who && `, ${who}`}`]
    : ["the nearest wall", "a wall"];
  const bound = value < enter ? `below ${metres(enter)}` : `not yet above ${metres(leave)}`;
  return value <= 0 ? `it touched ${any}` : `${near} was ${metres(value)} away, ${bound}`;
}

/** Name of the nearest of the robots that were considered in a decision; empty without. */
function nearest(view, robot, row) {
  const { run, fleet } = view;
  const pose = run.poses(run.step[row] * run.dt, new Float64Array(3 * run.robots));
  let least = Infinity;
  let found = "";
  for (const other of (run.considered(row) ?? []).slice(0, MOST_LOOKED_AT)) {
    const [a, b] = closestPoints(fleet, pose, robot, other);
    const away = Math.hypot(a[0] - b[0], a[1] - b[1]);
    if (away < least) [least, found] = [away, run.names[other]];
  }
  return found;
}

const saw = (run, { column, value }) => {
  if (column !== "collision_time") return metres(value);
  const horizon = run.header.why.horizon;
  return Number.isFinite(value) || !horizon ? seconds(value) : `none within ${decimal(horizon, 1)} s`;
};

/** What was seen, against the thresholds of that moment: those to enter, or in danger to leave it. */
export function limits(run, row) {
  const { thresholds, avoids } = run.header.why;
  if (!avoids) return [];
  const robotFirst = run.first.findLastIndex((first) => first <= row);
  const before = row > run.first[robotFirst] ? run.mode[row - 1] : -1;
  const wasDanger = before >= 0 && run.modes[before].danger;
  const isSafe = !run.modes[run.mode[row]]?.danger;
  return thresholds.map(({ column, enter, leave, boundary }) => {
    const value = run.column(`own:${column}`)[row];
    const ofWall = wasDanger && isSafe && boundary !== undefined && value <= leave; // it left for a wall
    const limit = ofWall ? boundary : wasDanger ? leave : enter;
    return { column, value, limit, enter, leave, ofWall, wasDanger, isShort: wasDanger ? value <= limit : value < limit };
  });
}

function seenTable(run, row, mode) {
  const states = limits(run, row);
  if (!states.length) return null;
  const rows = states.map((one) => {
    const unit = one.column === "collision_time" ? "s" : "m";
    const bound = amount(one.limit, unit) + (one.ofWall ? " (a boundary)" : "");
    const note = one.column === "collision_time" && mode?.danger ? " (under its new command)" : "";
    const known = !(one.column === "collision_time" && mode?.danger);
    return el(
      "tr", { class: one.isShort && known ? "short" : "" },
      el("th", { scope: "row" }, SEEN[one.column] + note),
      el("td", {}, saw(run, one)), el("td", {}, bound),
    );
  });
  const bounds = states[0].wasDanger ? "safe again above" : "danger below";
  const top = el("tr", {}, ...["", "it saw", bounds].map((words) => (words ? el("th", { scope: "col" }, words) : el("td", {}))));
  return el("table", { class: "seen" }, caption("What it saw, and its thresholds"), el("thead", {}, top), el("tbody", {}, rows));
}

function factTable(run, robot, row, go, time) {
  const facts = [];
  const add = (label, ...content) => facts.push([label, content]);
  const next = run.step[row] + run.hold[row];
  const { why, range } = run.header;
  const others = run.considered(row);
  const count = run.column("considered")[row];
  if (others) {
    const buttons = others.slice(0, MOST_OTHERS).map((other) =>
      button(run.names[other], () => go({ robot: other }), { class: "link" }),
    );
    const more = others.length > MOST_OTHERS ? ` and ${others.length - MOST_OTHERS} more` : "";
    add("considered", others.length ? buttons : "no robot", more);
  } else if (count >= 0) {
    add("considered", plural(count, "robot"));
  }
  if (range) add("range", `${decimal(range, 1)} m${why.priority ? `. ${why.priority}` : ""}`);
  const [x, y] = ["own:target_x", "own:target_y"].map((name) => run.column(name)[row]);
  if (Number.isFinite(x + y)) add("target", `(${decimal(x, 2)}, ${decimal(y, 2)}) m`);
  const given = run.commands(robot, time);
  const words = ["nominal", "filtered", "applied"].map((stage) => command(given[stage]));
  if (words.every((one) => one === words[0])) {
    add("command", `${words[0]} (nominal, filtered and applied)`);
  } else {
    ["nominal", "filtered", "applied"].forEach((stage, k) => add(stage, words[k]));
    if (given.apart > 0) add("", `(this page keeps these every ${decimal(given.apart, 2)} s)`);
  }
  const rest = [];
  const station = run.column("station")[row];
  if (Number.isFinite(station)) rest.push(`${decimal(station, 1)} m along its path`);
  const off = run.column("deviation")[row];
  if (Number.isFinite(off)) rest.push(`${metres(Math.abs(off))} ${off < 0 ? "right" : "left"} of it`);
  if (rest.length) add("place", rest.join(", "));
  const error = run.column("formation_error")[row];
  const formed = run.header.curves.error.name === "formation_error";
  if (Number.isFinite(error) && formed) add("formation error", metres(error));
  const isTold = (name) => limits(run, row).some((one) => one.column === name);
  for (const { name, unit, words: meaning } of run.header.columns) {
    if (PLACES.includes(name) || isTold(name)) continue;
    const value = run.column(`own:${name}`)[row];
    if (!Number.isNaN(value)) add(SEEN[name] ?? (meaning || name), amount(value, unit));
  }
  const rule = why.next ? `: ${why.next.words} ${why.next.equation}` : "";
  add("next decision", next * run.dt > run.duration ? "after the end" : `${decimal(next * run.dt, 2)} s${rule}`);
  const body = facts.map(([label, content]) =>
    el("tr", {}, el("th", { scope: "row" }, label), el("td", {}, content.flat().flatMap((one) => [one, " "]))),
  );
  return el("table", { class: "facts" }, caption("Its last decision"), el("tbody", {}, body));
}

/** The panel of one contact: what `physim validate` says of it. */
export function whyContact(view, k, go) {
  const { run, contacts } = view;
  const told_ = contacts.told[k];
  const robots = contacts.bodies(k).filter((body) => body < run.robots);
  const jump = el(
    "p", {}, ...robots.flatMap((robot) => [
      button(`What did ${run.names[robot]} decide?`, () => go({ robot, contact: -1 }), { class: "link" }), " ",
    ]),
  );
  const [a, b] = contacts.bodies(k).map((body) => run.names[body]);
  const title = el("h2", {}, `Contact at ${decimal(contacts.time(k), 2)} s: ${a} and ${b}`);
  if (!told_) {
    const where = contacts.place(k, contacts.began[k]);
    const how = contacts.swept[k] ? "between two samples" : plural(contacts.samples[k], "sample");
    return [title, el("p", {}, `At (${decimal(where.x, 2)}, ${decimal(where.y, 2)}) m, ${how}.`), jump];
  }
  const safe = told_.safe === null ? null : el(
    "p", {}, "Last safe moment: just before ",
    button(seconds(told_.safe), () => go({ time: told_.safe }), { class: "link" }),
    ". From there on the contact lay ahead at every decision.",
  );
  return [title, ...told_.lines.map((line) => el("p", {}, line)), safe, jump];
}
