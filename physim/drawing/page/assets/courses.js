// The rows of the plots: distances, formation error, collision times, modes.

export const DASHES = [[], [5, 3], [2, 2], [8, 3, 2, 3]]; // one a run
export const DASHED = ["", "dashed", "dotted", "dash-dotted"];
const FEW = 60;
const NEAR = [
  { name: "pair", column: "distance", colour: "link", words: "between robots (blue)", more: "to all that moves (blue)" },
  { name: "wall", column: "boundary_distance", colour: "reference", words: "to walls (grey)" },
];
const AHEAD = [{ name: "times", column: "collision_time", colour: "link", words: "" }];

/**
 * Rows of all runs together: title, limits, share of the height, and a function that draws; a note
 * of what its lines mean, and whether it shows the chosen run alone.
 */
export function courses(runs) {
  return [
    least(runs, NEAR, { title: "shortest distance [m]", share: 1.6, most: 0.9 }),
    errors(runs),
    least(runs, AHEAD, { title: "shortest collision time that decided [s]", share: 1, most: 1 }),
    modes(runs),
  ].filter(Boolean);
}

/** The least of all robots in each bin, with thresholds, and of the chosen robot its own; `most` is
 * the share of the values that fit. */
function least(runs, kinds, { title, share, most }) {
  const known = kinds.filter(({ name }) => runs.some((run) => run.header.curves[name]));
  if (!known.length) return null;
  const limits = [0, 0.5];
  for (const { name, column } of known) {
    const limit = thresholdOf(runs, column);
    if (limit) limits[1] = Math.max(limits[1], 1.3 * limit.leave);
    for (const run of runs.filter(({ header }) => header.curves[name])) {
      const values = run.array(name).filter(Number.isFinite).sort();
      if (!values.length) continue;
      limits[0] = Math.min(limits[0], values[0]);
      limits[1] = Math.max(limits[1], 1.1 * values[Math.floor(most * (values.length - 1))]);
    }
  }
  const draw = (context, frame, { colours, active, chosen }) => {
    for (const { name, column, colour } of known) {
      thresholds(context, frame, thresholdOf(runs, column), colours[colour]);
      runs.forEach((run, k) => {
        if (!run.header.curves[name]) return;
        run.bins ??= run.array.whole("bin");
        drawLine(context, frame, run, run.bins, run.array(name), colours[colour], 1.2, DASHES[k % 4]);
      });
    }
    if (chosen < 0) return;
    const run = runs[active];
    const mine = [run.first[chosen], run.first[chosen + 1]];
    const own = run.column(`own:${known[0].column}`).subarray(...mine);
    drawLine(context, frame, run, run.step.subarray(...mine), own, colours.ink, 1.5);
  };
  const beside = runs.some((run) => run.moving > run.robots);
  const words = [title, known.map((one) => (beside && one.more) || one.words).join(", ")].join(" ").trim();
  return { title: words, note: noteOf(runs, known), limits, share, draw };
}

/** What the lines of a row mean: the runs, or of one run the thresholds. */
function noteOf(runs, known) {
  if (runs.length > 1) {
    const shown = (run) => known.some(({ name }) => run.header.curves[name]);
    return runs.slice(1, 4).map((run, k) => (shown(run) ? `${DASHED[k + 1]}: ${run.label}` : ""))
      .filter(Boolean).join(", ");
  }
  if (!thresholdOf(runs, known[0].column)) return "";
  return `level lines${known.length > 1 ? ", in the same colours" : ""}: danger below, dashed: safe again above`;
}

/** Thresholds of one run, where one controller has any; of several their dashes tell runs apart. */
function thresholdOf(runs, column) {
  const having = runs[0].header.why.drivers.filter((one) => one.avoids && one.thresholds.length);
  if (runs.length > 1 || having.length !== 1) return undefined;
  return having[0].thresholds.find((one) => one.column === column);
}

/** Where danger begins, and above which it can end. */
function thresholds(context, frame, limit, colour) {
  if (!limit) return;
  for (const [value, dash] of [[limit.enter, []], [limit.leave, [4, 4]]]) {
    stroke(context, colour, 1, dash, () => {
      context.moveTo(frame.left, frame.y(value));
      context.lineTo(frame.left + frame.width, frame.y(value));
    });
  }
}

/** A line through values at steps of a run; none where there is no value, or beyond the limits. */
function drawLine(context, frame, run, steps, values, colour, width, dash = []) {
  const [low, high] = frame.limits;
  let open = false;
  stroke(context, colour, width, dash, () => values.forEach((value, k) => {
    const there = value >= low && value <= high;
    if (there) {
      const [x, y] = [frame.x(steps[k] * run.dt), frame.y(value)];
      if (!open) context.moveTo(x, y);
      context.lineTo(open ? x : x + 0.8, y);
    }
    open = there;
  }));
}

function stroke(context, colour, width, dash, trace) {
  context.setLineDash(dash);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.beginPath();
  trace();
  context.stroke();
  context.setLineDash([]);
}

/** Moment `k` of `count` that are spread evenly over a run [s]. */
const moment = (run, k, count) => run.begin + ((run.duration - run.begin) * k) / (count - 1);

/** Fills between two functions of such moments. */
function fill(context, frame, run, count, low, high) {
  const x = (k) => frame.x(moment(run, k, count));
  context.beginPath();
  for (let k = 0; k < count; k++) context.lineTo(x(k), frame.y(high(k)));
  for (let k = count - 1; k >= 0; k--) context.lineTo(x(k), frame.y(low(k)));
  context.fill();
}

function errors(runs) {
  const { title, bands } = runs[0].header.curves.error;
  let most = 0.1;
  for (const run of runs) {
    for (const value of run.array(run.header.curves.error.bands ? "bands" : "error")) {
      if (Number.isFinite(value)) most = Math.max(most, Math.abs(value));
    }
  }
  const draw = (context, frame, { colours, active, chosen }) => {
    const run = runs[active];
    const isCrowd = run.header.curves.error.bands;
    if (isCrowd) drawBands(context, frame, run, colours.band);
    const steps = (run.errorStep ??= run.array.whole("error_step"));
    const values = (run.error ??= run.array("error"));
    for (let robot = 0; robot < run.robots; robot++) {
      if (isCrowd && robot !== chosen) continue;
      const mine = values.subarray(robot * steps.length, (robot + 1) * steps.length);
      const colour = colours.robots[robot % colours.robots.length];
      drawLine(context, frame, run, steps, mine, colour, robot === chosen ? 2.5 : 1);
    }
  };
  return { title, limits: [-most, most], share: 1.1, ofOne: true, named: runs.length === 1 && !bands, draw };
}

/** Minimum, 5, 25, 50, 75, 95 % and maximum of a crowd. */
function drawBands(context, frame, run, colour) {
  const levels = run.array("bands");
  const count = levels.length / 7;
  const at = (level) => (k) => levels[level * count + k] || 0;
  context.fillStyle = colour;
  for (const [low, high, opacity] of [[0, 6, 0.18], [1, 5, 0.25], [2, 4, 0.4]]) {
    context.globalAlpha = opacity;
    fill(context, frame, run, count, at(low), at(high));
  }
  context.globalAlpha = 1;
  stroke(context, colour, 1.2, [], () => {
    for (let k = 0; k < count; k++) context.lineTo(frame.x(moment(run, k, count)), frame.y(at(3)(k)));
  });
}

function modes(runs) {
  if (runs.every((run) => run.header.modeless || !run.modes.length)) return null;
  const most = Math.max(...runs.map((run) => run.robots));
  const draw = (context, frame, { colours, active, chosen }) => {
    const run = runs[active];
    if (run.array.has("mode_counts")) drawShares(context, frame, run, colours);
    else drawSpans(context, frame, run, colours, chosen);
  };
  const crowd = most > FEW;
  const title = crowd ? "robots by mode" : "mode of each robot, the first on top";
  return { title, share: crowd ? 1 : Math.min(2.2, 0.7 + 0.11 * most), ofOne: true, draw };
}

const modeColour = (run, mode, colours) => run.modes[mode]?.colour ?? colours.undecided;

function drawSpans(context, frame, run, colours, chosen) {
  const high = frame.height / run.robots;
  const gap = high > 4 ? 1 : 0;
  for (let robot = 0; robot < run.robots; robot++) {
    const top = frame.top + robot * high;
    for (const [from, to, mode] of run.spans(robot)) {
      context.fillStyle = modeColour(run, mode, colours);
      const left = frame.x(from);
      context.fillRect(left, top, Math.max(frame.x(to) - left, 0.7), high - gap);
    }
    if (robot !== chosen) continue;
    context.strokeStyle = colours.ink;
    context.lineWidth = 1.5;
    context.strokeRect(frame.left, top, frame.width, high - gap);
  }
}

/** How many robots of a crowd have each mode, one upon the other. */
function drawShares(context, frame, run, colours) {
  const counts = run.array.whole("mode_counts");
  const kinds = run.modes.length + 1;
  const moments = counts.length / kinds;
  const whole = { ...frame, y: (robots) => frame.top + frame.height * (1 - robots / run.robots) };
  let below = new Float64Array(moments);
  for (let kind = 0; kind < kinds; kind++) {
    const above = below.map((count, k) => count + counts[kind * moments + k]);
    context.fillStyle = modeColour(run, kind, colours);
    fill(context, whole, run, moments, (k) => below[k], (k) => above[k]);
    below = above;
  }
}
