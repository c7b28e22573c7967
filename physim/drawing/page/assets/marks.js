// Signs over the robots: contacts, targets, the closest pair, names, and what a chosen robot saw.

import { toPixels } from "./camera.js";
import { closestPoints } from "./robots.js";
import { metres, multiple } from "./words.js";

const FLASH = 0.5; // [s of the reader's time] that a ring grows round a new contact
const still = matchMedia("(prefers-reduced-motion: reduce)");
const FULL = 2 * Math.PI;

export function disc(context, x, y, radius, fill, edge, width = 1) {
  context.beginPath();
  context.arc(x, y, radius, 0, FULL);
  if (fill) {
    context.fillStyle = fill;
    context.fill();
  }
  if (edge) {
    context.strokeStyle = edge;
    context.lineWidth = width;
    context.stroke();
  }
}

export function line(context, from, to, colour, width) {
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke();
}

/** A cross, or for a contact between samples a diamond; too deep to be physical: white on a disc. */
export function drawContact(context, x, y, { swept, deep }, colours, small = false) {
  if (deep) {
    disc(context, x, y, small ? 8 : 11, colours.contact, colours.paper, 2);
  }
  const arm = (small ? 4 : 7) - (deep ? 2 : 0);
  const path = new Path2D();
  if (swept) {
    path.moveTo(x, y - arm - 2);
    path.lineTo(x + arm + 2, y);
    path.lineTo(x, y + arm + 2);
    path.lineTo(x - arm - 2, y);
    path.closePath();
  } else {
    path.moveTo(x - arm, y - arm);
    path.lineTo(x + arm, y + arm);
    path.moveTo(x - arm, y + arm);
    path.lineTo(x + arm, y - arm);
  }
  for (const [colour, width] of deep
    ? [["#ffffff", 3]]
    : [[colours.paper, small ? 5 : 7], [colours.contact, small ? 2 : 4]]) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke(path);
  }
}

export function drawContacts(context, shown, lens, colours, speed, crowd) {
  const rings = [];
  for (const one of shown) {
    const [x, y] = toPixels(lens, one.x, one.y);
    const grown = one.age / (FLASH * Math.max(speed, 1e-6));
    const isFirst = rings.every(([rx, ry]) => Math.hypot(rx - x, ry - y) > 24);
    if (grown < 1 && isFirst) {
      rings.push([x, y]);
      const radius = still.matches ? 18 : 9 + 25 * grown;
      disc(context, x, y, radius, null, colours.paper, 7);
      disc(context, x, y, radius, null, colours.contact, 4);
    }
    drawContact(context, x, y, one, colours, crowd);
  }
}

/** Targets as small rings, joined to their robots. */
export function drawTargets(context, run, pose, time, lens, seen, colours) {
  const xs = run.column("own:target_x");
  const ys = run.column("own:target_y");
  for (const robot of seen) {
    const row = run.decision(robot, time);
    if (row < 0 || !Number.isFinite(xs[row] + ys[row])) continue;
    const from = toPixels(lens, pose[3 * robot], pose[3 * robot + 1]);
    const to = toPixels(lens, xs[row], ys[row]);
    line(context, from, to, colours.quiet, 1);
    disc(context, ...to, 3, colours.paper, colours.ink);
  }
}

/** Joins the closest points of two robots and writes their distance. */
export function drawClosest(context, fleet, pose, lens, { a, b, distance }, colours) {
  const points = closestPoints(fleet, pose, a, b);
  const [from, to] = points.map(([x, y]) => toPixels(lens, x, y));
  line(context, from, to, colours.paper, 5);
  line(context, from, to, colours.ink, 2);
  for (const end of [from, to]) disc(context, ...end, 3, colours.ink);
  const words = distance > 0 ? metres(distance) : "contact";
  return { words, x: (from[0] + to[0]) / 2, y: (from[1] + to[1]) / 2, up: 14, bold: true };
}

/** What a chosen robot saw: its range, the robots it considered, the way its command leads. */
export function drawSight(context, run, robot, time, pose, lens, colours) {
  const at = toPixels(lens, pose[3 * robot], pose[3 * robot + 1]);
  const { range } = run.header;
  if (range) {
    context.setLineDash([6, 6]);
    disc(context, ...at, range * lens.scale, null, colours.quiet, 1);
    context.setLineDash([]);
  }
  for (const other of run.considered(run.decision(robot, time)) ?? []) {
    const to = toPixels(lens, pose[3 * other], pose[3 * other + 1]);
    line(context, at, to, colours.ink, 1.2);
    disc(context, ...to, 3, colours.ink);
  }
  const [v, omega, lateral = 0] = run.commands(robot, time).applied;
  context.beginPath();
  let [x, y, heading] = pose.subarray(3 * robot, 3 * robot + 3);
  context.moveTo(...at);
  for (let k = 0; k < 20; k++) {
    heading += omega * 0.025;
    x += 0.05 * (v * Math.cos(heading) - lateral * Math.sin(heading));
    y += 0.05 * (v * Math.sin(heading) + lateral * Math.cos(heading));
    heading += omega * 0.025;
    context.lineTo(...toPixels(lens, x, y));
  }
  context.strokeStyle = colours.link;
  context.lineWidth = 3;
  context.stroke();
}

/** A bar of a round length, in the lower left corner. */
export function drawScale(context, length, lens, height, colours) {
  const [x, y, end] = [14, height - 14, 14 + length * lens.scale];
  const path = new Path2D(`M${x} ${y - 5}V${y + 5}M${x} ${y}H${end}M${end} ${y - 5}V${y + 5}`);
  context.strokeStyle = colours.paper;
  context.lineWidth = 5;
  context.stroke(path);
  context.strokeStyle = colours.ink;
  context.lineWidth = 2;
  context.stroke(path);
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "left";
  context.textBaseline = "middle";
  context.lineWidth = 3;
  context.strokeStyle = colours.paper;
  const words = `${multiple(length, length)} m`;
  context.strokeText(words, end + 8, y);
  context.fillStyle = colours.ink;
  context.fillText(words, end + 8, y);
}
