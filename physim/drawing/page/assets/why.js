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

/** What a column is called: what is nearest need not be a robot where more moves. */
const sensed = (run, column) =>
  column === "distance" && run.moving > run.robots ? "nearest body it considered" : SEEN[column];

/** What the controller of a robot goes by. */
const driverOf = (run, robot) =>
  run.header.why.drivers.find(({ robots }) => !robots || robots.includes(robot));

/** The panel of one robot; `go` is called with what to show instead: {time, robot, contact}. */
export function whyRobot(view, robot, time, go) {
  const { run } = view;
  const row = run.decision(robot, time);
  const name = run.names[robot];
  if (row < 0) {
    const known = run.header.judged ? "A log of poses does not tell what it decided." : `${name} has not decided anything yet.`;
    return [head(name, null), el("p", {}, known), story(view, robot, go)];
  }
  const mode = run.mode[row] < 0 ? null : run.modes[run.mode[row]];
  const rule = run.header.why.rules[run.rule[row]] ?? null;
  return [
    head(name, mode),
    el("p", { class: "because" }, because(view, robot, row, mode, rule)),
    rule ? el("p", { class: "rule" }, el("strong", {}, rule.words), rule.prose ? `: ${rule.prose}` : "") : null,
    seenTable(run, row, mode),
    story(view, robot, go),
    factTable(run, robot, row, go, time),
  ];
}

function head(name, mode) {
  const chip = mode && el("span", { class: "chip" }, mode.words);
  if (chip) chip.style.setProperty("--mode", mode.colour);
  return el("h2", {}, name, " ", chip);
}

/** A table of rows: their class, label and cells. */
function tableOf(name, caption, rows, top = null) {
  const lines = rows.map(([kind, label, ...cells]) =>
    el("tr", { class: kind }, el("th", { scope: "row" }, label), cells.map((cell) => el("td", {}, cell))));
  return el("table", { class: name }, el("caption", { class: "unseen" }, caption), top, el("tbody", {}, lines));
}

/** One or two sentences: what made it decide as it did. */
export function because(view, robot, row, mode, rule) {
  const { run } = view;
  const at = `At ${seconds(run.step[row] * run.dt)} ${run.names[robot]}`;
  const does = `${at} decided to ${motion(...["nominal_v", "nominal_omega", "nominal_lateral"].map((column) => run.column(column)[row]))}`;
  const states = limits(run, row);
  if (!states.length || !mode) return `${does}${driverOf(run, robot).avoids ? "" : "; its avoidance is off"}.`;
  if (!mode.danger) {
    if (rule?.name === "stop") return `${at} stands at its stop.`;
    const seen = states.filter((one) => !Number.isNaN(one.value)).map((one) => `${sensed(run, one.column)} ${saw(run, row, one)}`);
    return seen.length ? `${does}; nothing was near: ${seen.join(", ")}.` : `${does}.`;
  }
  const near = states.filter((one) => one.isShort && one.column !== "collision_time")
    .map((one) => told(one, run, one.column === "distance" ? nearest(view, robot, row) : -1));
  const time = states.find((one) => one.column === "collision_time");
  if (!near.length && time) {
    const until = `${time.wasDanger ? "within" : "in less than"} ${seconds(time.limit)}`;
    near.push(`with its safe-mode command it would touch a robot or a wall ${until}`);
  }
  if (!states[0].wasDanger) return `${does}, because ${near.join(" and ")}.`;
  const clear = states.map(({ column, limit }) => `${sensed(run, column)} above ${amount(limit, unitOf(column))}`);
  return `${does}. It leaves danger mode only when all of these hold: ${clear.join(", ")}. But ${near.join(" and ")}.`;
}

const unitOf = (column) => (column === "collision_time" ? "s" : "m");

/** A command as people say it. */
function motion(...command) {
  const [v, omega, lateral] = command.map((one) => (Math.abs(one) < 5e-3 ? 0 : one)); // as they are shown
  const side = omega > 0 ? "left" : "right";
  const slides = lateral ? `slide ${lateral > 0 ? "left" : "right"} at ${decimal(Math.abs(lateral), 2)} m/s` : "";
  const turns = omega ? `, turning ${side}` : "";
  if (slides && !v) return slides + turns;
  if (!v) return omega ? `turn ${side} where it stands` : "stand still";
  const drive = v > 0 ? `drive at ${decimal(v, 2)} m/s` : `back up at ${decimal(-v, 2)} m/s`;
  return slides ? `${drive} and ${slides}${turns}` : drive + (turns || " straight on");
}

function told({ column, value, enter, leave }, run, body) {
  const [kind, who] = body < 0 ? ["robot", ""] : [run.kind(body), run.names[body]];
  const [near, any] = column === "distance"
    ? [`the nearest ${kind} it considered${who && `, ${who},`}`,
       `${kind === "obstacle" ? "an" : "a"} ${kind} it considered${who && `, ${who}`}`]
    : ["the nearest wall", "a wall"];
  const bound = value < enter ? `below ${metres(enter)}` : `not yet above ${metres(leave)}`;
  return value <= 0 ? `it touched ${any}` : `${near} was ${metres(value)} away, ${bound}`;
}

/** The nearest of the bodies that were considered in a decision; -1 without. */
function nearest(view, robot, row) {
  const { run, fleet } = view;
  const pose = run.poses(run.step[row] * run.dt, new Float64Array(3 * run.moving));
  let least = Infinity;
  let found = -1;
  for (const other of (run.considered(row) ?? []).slice(0, MOST_LOOKED_AT)) {
    const [a, b] = closestPoints(fleet, pose, robot, other);
    const away = Math.hypot(a[0] - b[0], a[1] - b[1]);
    if (away < least) [least, found] = [away, other];
  }
  return found;
}

const saw = (run, row, { column, value }) => {
  if (column !== "collision_time") return metres(value);
  const { horizon } = driverOf(run, robotOf(run, row));
  return Number.isFinite(value) || !horizon ? seconds(value) : `none within ${decimal(horizon, 1)} s`;
};

const robotOf = (run, row) => run.first.findLastIndex((first) => first <= row);

/** What was seen, against the thresholds of that moment: those to enter, or in danger to leave it. */
export function limits(run, row) {
  const robot = robotOf(run, row);
  const { thresholds, avoids } = driverOf(run, robot);
  if (!avoids) return [];
  const before = row > run.first[robot] ? run.mode[row - 1] : -1;
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
    const isNew = one.column === "collision_time" && mode?.danger;
    const bound = amount(one.limit, unitOf(one.column)) + (one.ofWall ? " (a boundary)" : "");
    return [one.isShort && !isNew ? "short" : "", sensed(run, one.column) + (isNew ? " (under its new command)" : ""), saw(run, row, one), bound];
  });
  const heads = ["it sensed", states[0].wasDanger ? "safe again above" : "danger below"];
  const top = el("thead", {}, el("tr", {}, el("td", {}), heads.map((words) => el("th", { scope: "col" }, words))));
  return tableOf("seen", "What it sensed, and its thresholds", rows, top);
}

function factTable(run, robot, row, go, time) {
  const rows = [];
  const add = (label, ...content) => rows.push(["", label, content.flatMap((one) => [one, " "])]);
  const at = (name) => run.column(name)[row];
  const next = (run.step[row] + run.hold[row]) * run.dt;
  const { range } = run.header;
  const why = driverOf(run, robot);
  if (why.robots) add("controller", why.controller);
  const drive = run.header.drives?.[robot];
  if (drive) {
    const angle = (run.steering(robot, time) * 180) / Math.PI;
    const side = angle < 0 ? "right" : "left";
    add("drive", Math.abs(angle) >= 0.05 ? `${drive}, wheels ${decimal(Math.abs(angle), 1)}° to the ${side} now` : drive);
  }
  const others = run.considered(row);
  if (others) {
    const buttons = others.slice(0, MOST_OTHERS).map((other) => (other < run.robots
      ? button(run.names[other], () => go({ robot: other }), { class: "link" }) : run.names[other]));
    const more = others.length > MOST_OTHERS ? [`and ${others.length - MOST_OTHERS} more`] : [];
    add("considered", ...(others.length ? [...buttons, ...more] : ["no robot"]));
  } else if (at("considered") >= 0) add("considered", plural(at("considered"), "robot"));
  if (range) add("range", `${decimal(range, 1)} m${why.priority ? `. ${why.priority}` : ""}`);
  const [x, y] = PLACES.map((name) => at(`own:${name}`));
  if (Number.isFinite(x + y)) add("target", `(${decimal(x, 2)}, ${decimal(y, 2)}) m`);
  const given = run.commands(robot, time);
  const stages = ["nominal", "filtered", "applied"].map((stage) => [stage, command(given[stage])]);
  if (stages.every(([, words]) => words === stages[0][1])) {
    add("command", `${stages[0][1]} (nominal, filtered and applied)`);
  } else {
    for (const one of stages) add(...one);
    if (given.apart > 0) add("", `(this page keeps these every ${seconds(given.apart)})`);
  }
  const [station, off] = [at("station"), at("deviation")];
  const place = [
    Number.isFinite(station) ? `${decimal(station, 1)} m along its path` : "",
    Number.isFinite(off) ? `${metres(Math.abs(off))} ${off < 0 ? "right" : "left"} of it` : "",
  ].filter(Boolean);
  if (place.length) add("place", place.join(", "));
  const error = at("formation_error");
  const formed = run.header.curves.error.name === "formation_error";
  if (Number.isFinite(error) && formed) add("formation error", metres(error));
  const shown = [...PLACES, ...limits(run, row).map((one) => one.column)];
  for (const { name, unit, words } of run.header.columns) {
    const value = at(`own:${name}`);
    if (!shown.includes(name) && !Number.isNaN(value)) add(SEEN[name] ?? (words || name), amount(value, unit));
  }
  const rule = why.next ? `: ${why.next.words} ${why.next.equation}` : "";
  add("next decision", next > run.duration ? "after the end" : `${seconds(next)}${rule}`);
  return tableOf("facts", "Its last decision", rows);
}

/** The panel of one contact: what `physim validate` says of it. */
export function whyContact(view, k, go) {
  const { run, contacts } = view;
  const said = contacts.told[k];
  const names = contacts.bodies(k).map((body) => run.names[body]);
  const title = el("h2", {}, `Contact at ${seconds(contacts.time(k))}: ${names.join(" and ")}`);
  const robots = contacts.bodies(k).filter((body) => body < run.robots);
  const jump = el("p", {}, robots.flatMap((robot) => [
    button(`What did ${run.names[robot]} decide?`, () => go({ robot, contact: -1 }), { class: "link" }), " ",
  ]));
  if (!said) {
    const { x, y } = contacts.place(k, contacts.began[k]);
    const how = contacts.swept[k] ? "between two samples" : plural(contacts.samples[k], "sample");
    return [title, el("p", {}, `At (${decimal(x, 2)}, ${decimal(y, 2)}) m, ${how}.`), jump];
  }
  const safe = said.safe === null ? null : el(
    "p", {}, "Last safe moment: just before ",
    button(seconds(said.safe), () => go({ time: said.safe }), { class: "link" }),
    ". From then on, every decision led to the contact.",
  );
  return [title, ...said.lines.map((line) => el("p", {}, line)), safe, jump];
}
