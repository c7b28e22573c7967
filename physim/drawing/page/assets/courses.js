// The rows of the plots: distances, formation error, collision times, modes.

export const DASHES = [[], [5, 3], [2, 2], [8, 3, 2, 3]]; // one a run
export const DASHED = ["", "dashed", "dotted", "dash-dotted"];
const FEW = 60;

/**
 * Rows of all runs together: title, limits, share of the height, and a function that draws; a note
 * of what its lines mean, and whether it shows the chosen run alone.
 */
export function courses(runs) {
  return [distances(runs), errors(runs), times(runs), modes(runs)].filter(Boolean);
}

/** What the lines of a row mean: the runs, or of one run the thresholds. */
function noteOf(runs, shown, column, colours = "") {
  if (runs.length > 1) {
    const said = runs.slice(1, 4).map((run, k) => (shown.includes(run) ? `${DASHED[k + 1]}: ${run.label}` : ""));
    return said.filter(Boolean).join(", ");
  }
  const limit = thresholdOf(runs[0], column);
  return limit && runs[0].header.why.avoids ? `level lines${colours}: danger below, dashed: safe again above` : "";
}

function errors(runs) {
  const { title } = runs[0].header.curves.error;
  let most = 0.1;
  for (const run of runs) {
    const { bands } = run.header.curves.error;
    for (const value of run.array(bands ? "bands" : "error")) {
      if (Number.isFinite(value)) most = Math.max(most, Math.abs(value));
    }
  }
  const draw = (context, frame, { colours, active, chosen }) => {
    const run = runs[active];
    const { error } = run.header.curves;
    if (error.bands) drawBands(context, frame, run, colours);
    for (let robot = 0; robot < run.robots; robot++) {
      if (error.bands && robot !== chosen) continue;
      const colour = colours.robots[robot % colours.robots.length];
      drawError(context, frame, run, robot, colour, robot === chosen ? 2.5 : 1);
    }
  };
  const named = runs.length === 1 && !runs[0].header.curves.error.bands;
  return { title, limits: [-most, most], share: 1.1, ofOne: true, named, draw };
}

/** Minimum, 5, 25, 50, 75, 95 % and maximum of a crowd. */
function drawBands(context, frame, run, colours) {
  const levels = run.array("bands");
  const count = levels.length / 7;
  const time = (k) => (run.duration * k) / (count - 1);
  context.fillStyle = colours.band;
  for (const [low, high, opacity] of [[0, 6, 0.18], [1, 5, 0.25], [2, 4, 0.4]]) {
    context.globalAlpha = opacity;
    context.beginPath();
    for (let k = 0; k < count; k++) context.lineTo(frame.x(time(k)), frame.y(levels[high * count + k] || 0));
    for (let k = count - 1; k >= 0; k--) context.lineTo(frame.x(time(k)), frame.y(levels[low * count + k] || 0));
    context.fill();
  }
  context.globalAlpha = 1;
  context.strokeStyle = colours.band;
  context.beginPath();
  for (let k = 0; k < count; k++) context.lineTo(frame.x(time(k)), frame.y(levels[3 * count + k] || 0));
  context.stroke();
}

/** Formation error or deviation of one robot, at samples of the run. */
function drawError(context, frame, run, robot, colour, width) {
  const steps = (run.errorStep ??= run.array.whole("error_step"));
  const values = (run.error ??= run.array("error"));
  const first = robot * steps.length;
  drawLine(context, frame, run, steps, values.subarray(first, first + steps.length), colour, width);
}

/** A figure of one robot, at its decisions. */
function drawSteps(context, frame, run, robot, values, colour, width) {
  const mine = [run.first[robot], run.first[robot + 1]];
  drawLine(context, frame, run, run.step.subarray(...mine), values.subarray(...mine), colour, width);
}

function drawLine(context, frame, run, steps, values, colour, width) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.beginPath();
  const [low, high] = frame.limits;
  let open = false;
  values.forEach((value, k) => {
    const there = value >= low && value <= high; // so neither NaN nor what lies beyond the plot
    if (there) {
      const x = frame.x(steps[k] * run.dt);
      if (open) context.lineTo(x, frame.y(value));
      else context.moveTo(x, frame.y(value));
    }
    open = there;
  });
  context.stroke();
}

function distances(runs) {
  const shown = runs.filter((run) => run.header.curves.pair || run.header.curves.wall);
  if (!shown.length) return null;
  const limit = thresholdOf(runs[0], runs[0].header.curves.pair ? "distance" : "boundary_distance");
  let most = limit ? 1.3 * limit.leave : 0.5;
  let least = 0;
  for (const run of shown) {
    for (const name of ["pair", "wall"]) {
      if (!run.header.curves[name]) continue;
      const values = run.array(name).filter(Number.isFinite).sort();
      if (!values.length) continue;
      most = Math.max(most, values[Math.floor(0.9 * values.length)] * 1.1);
      least = Math.min(least, values[0]);
    }
  }
  const draw = (context, frame, { colours, active, chosen }) => {
    const { pair, wall } = runs[active].header.curves;
    if (pair) thresholds(context, frame, runs, "distance", colours.link);
    if (wall) thresholds(context, frame, runs, "boundary_distance", colours.reference);
    runs.forEach((run, k) => {
      if (run.header.curves.wall) drawBins(context, frame, run, "wall", colours.reference, DASHES[k % 4]);
      if (run.header.curves.pair) drawBins(context, frame, run, "pair", colours.link, DASHES[k % 4]);
    });
    const run = runs[active];
    if (chosen >= 0) drawSteps(context, frame, run, chosen, run.column("own:distance"), colours.ink, 1.5);
  };
  const words = [
    shown.some((run) => run.header.curves.pair) ? "between robots (blue)" : "",
    shown.some((run) => run.header.curves.wall) ? "to walls (grey)" : "",
  ].filter(Boolean);
  const title = `shortest distance [m] ${words.join(", ")}`;
  const { pair, wall } = runs[0].header.curves;
  const note = noteOf(runs, shown, pair ? "distance" : "boundary_distance", pair && wall ? ", in the same colours" : "");
  return { title, note, limits: [least, most], share: 1.6, draw };
}

function times(runs) {
  const shown = runs.filter((run) => run.header.curves.times);
  if (!shown.length) return null;
  let most = 0.5;
  for (const run of shown) {
    for (const value of run.array("times")) if (Number.isFinite(value)) most = Math.max(most, value);
  }
  const draw = (context, frame, { colours, active, chosen }) => {
    thresholds(context, frame, runs, "collision_time", colours.quiet);
    runs.forEach((run, k) => {
      if (run.header.curves.times) drawBins(context, frame, run, "times", colours.link, DASHES[k % 4]);
    });
    const run = runs[active];
    if (chosen >= 0) drawSteps(context, frame, run, chosen, run.column("own:collision_time"), colours.ink, 1.5);
  };
  const title = "shortest collision time that decided [s]";
  return { title, note: noteOf(runs, shown, "collision_time"), limits: [0, most], share: 1, draw };
}

const thresholdOf = (run, column) => run.header.why.thresholds.find((one) => one.column === column);

/** Where danger begins, and above which it can end. */
function thresholds(context, frame, runs, column, colour) {
  if (runs.length > 1) return; // their dashes tell runs apart
  const [run] = runs;
  const limit = thresholdOf(run, column);
  if (!limit || !run.header.why.avoids) return;
  context.lineWidth = 1;
  context.strokeStyle = colour;
  for (const [value, dash] of [[limit.enter, []], [limit.leave, [4, 4]]]) {
    context.setLineDash(dash);
    context.beginPath();
    context.moveTo(frame.left, frame.y(value));
    context.lineTo(frame.left + frame.width, frame.y(value));
    context.stroke();
  }
  context.setLineDash([]);
}

/** The least of each bin, as a line; no line where there is none. */
function drawBins(context, frame, run, name, colour, dash) {
  run.bins ??= run.array.whole("bin");
  const values = run.array(name);
  context.setLineDash(dash);
  context.strokeStyle = colour;
  context.lineWidth = 1.2;
  context.beginPath();
  const [low, high] = frame.limits;
  let open = false;
  values.forEach((value, k) => {
    const there = value >= low && value <= high;
    if (there) {
      const [x, y] = [frame.x(run.bins[k] * run.dt), frame.y(value)];
      if (open) context.lineTo(x, y);
      else {
        context.moveTo(x, y);
        context.lineTo(x + 0.8, y);
      }
    }
    open = there;
  });
  context.stroke();
  context.setLineDash([]);
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

function drawSpans(context, frame, run, colours, chosen) {
  const high = frame.height / run.robots;
  for (let robot = 0; robot < run.robots; robot++) {
    const top = frame.top + robot * high;
    const gap = high > 4 ? 1 : 0;
    for (const [from, to, mode] of run.spans(robot)) {
      context.fillStyle = mode < 0 ? colours.undecided : run.modes[mode].colour;
      const left = frame.x(from);
      context.fillRect(left, top, Math.max(frame.x(to) - left, 0.7), high - gap);
    }
    if (robot !== chosen) continue;
    context.strokeStyle = colours.ink;
    context.lineWidth = 1.5;
    context.strokeRect(frame.left, top, frame.width, high - gap);
  }
}

function drawShares(context, frame, run, colours) {
  const counts = run.array.whole("mode_counts");
  const kinds = run.modes.length + 1;
  const moments = counts.length / kinds;
  const below = new Float64Array(moments);
  for (let kind = 0; kind < kinds; kind++) {
    context.fillStyle = kind < run.modes.length ? run.modes[kind].colour : colours.undecided;
    context.beginPath();
    const y = (k) => frame.top + frame.height * (1 - below[k] / run.robots);
    const x = (k) => frame.x((run.duration * k) / (moments - 1));
    for (let k = 0; k < moments; k++) context.lineTo(x(k), y(k));
    for (let k = moments - 1; k >= 0; k--) {
      below[k] += counts[kind * moments + k];
      context.lineTo(x(k), y(k));
    }
    context.fill();
  }
}
