// Robots as they stand at a time: filled by mode, with a heading mark; and where they came from.
// Movers and what robots push have no mark, and the colour of their kind.

import { lastAtMost } from "./run.js";

const MARK_FROM = 5; // [px] size from which heading marks are drawn
const TRAIL_STEPS = 24;
const CROWD_STEPS = 4;
const FAR = 0.05; // [s] beside a sample, from which on figures of that are not those of now
const FADES = 6; // steps in which a trail fades

/** Shapes of the robots of a run, ready to be placed. */
export class Fleet {
  constructor(run) {
    this.run = run;
    const { shapes, shape } = run.header.scene;
    this.shapes = shapes.map(({ rings, mark, eccentric }) => ({
      rings: rings.map((ring) => Float64Array.from(ring.flat())),
      mark: Float64Array.from(mark.flat()),
      eccentric,
      reach: Math.max(...rings.flat().map(([x, y]) => Math.hypot(x, y))),
    }));
    this.shape = shape;
    this.reach = shape.map((number) => this.shapes[number].reach);
    this.largest = Math.max(...this.reach.slice(0, run.robots));
  }

  /** Corners [px], flat, of a ring of a robot's frame at its pose in `pose`. */
  static placed(ring, pose, at, lens) {
    const c = Math.cos(pose[at + 2]) * lens.scale;
    const s = Math.sin(pose[at + 2]) * lens.scale;
    const x = pose[at] * lens.scale + lens.x;
    const y = lens.y - pose[at + 1] * lens.scale;
    const found = new Float64Array(ring.length);
    for (let k = 0; k < ring.length; k += 2) {
      found[k] = x + c * ring[k] - s * ring[k + 1];
      found[k + 1] = y - s * ring[k] - c * ring[k + 1];
    }
    return found;
  }

  /** Outline [px] of a robot, its rings flat. */
  outline(robot, pose, lens) {
    const { rings } = this.shapes[this.shape[robot]];
    return rings.map((ring) => Fleet.placed(ring, pose, 3 * robot, lens));
  }

  /** Whether a robot is in a view of some size. */
  isSeen(robot, pose, lens, [width, height]) {
    const reach = this.reach[robot] * lens.scale + 4;
    const x = pose[3 * robot] * lens.scale + lens.x;
    const y = lens.y - pose[3 * robot + 1] * lens.scale;
    return x > -reach && y > -reach && x < width + reach && y < height + reach;
  }

  /** Draws the robots in `seen`, those of one colour in one go. */
  draw(context, pose, lens, seen, colourOf, { ghost = false, dash = [] } = {}) {
    const groups = new Map();
    const marks = new Path2D();
    const withMarks = this.largest * lens.scale > MARK_FROM && !ghost;
    for (const robot of seen) {
      const colour = colourOf(robot);
      if (!groups.has(colour)) groups.set(colour, new Path2D());
      for (const ring of this.outline(robot, pose, lens)) trace(groups.get(colour), ring);
      if (!withMarks || robot >= this.run.robots) continue;
      const { mark } = this.shapes[this.shape[robot]];
      trace(marks, Fleet.placed(mark, pose, 3 * robot, lens));
    }
    for (const [colour, path] of groups) {
      context.fillStyle = colour;
      context.strokeStyle = ghost ? colour : darker(colour);
      context.lineWidth = ghost ? 1.5 : Math.min(1, 0.15 * this.largest * lens.scale);
      if (!ghost) context.fill(path, "evenodd");
      context.setLineDash(dash);
      context.stroke(path);
    }
    context.setLineDash([]);
    context.fillStyle = "#ffffff";
    context.fill(marks);
  }

  /** Draws the front wheels of cars as they are turned at a time. */
  drawWheels(context, pose, lens, seen, time, colourOf) {
    for (const robot of seen) {
      const wheels = this.run.header.scene.wheels?.[robot];
      if (!wheels) continue;
      const turned = this.run.steering(robot, time);
      const [x, y] = [Math.cos(turned) * wheels.half, Math.sin(turned) * wheels.half];
      const path = new Path2D();
      for (const [ax, ay] of wheels.at) {
        trace(path, Fleet.placed([ax - x, ay - y, ax + x, ay + y], pose, 3 * robot, lens));
      }
      context.strokeStyle = darker(colourOf(robot));
      context.lineWidth = 2.5;
      context.stroke(path);
    }
  }

  /** Outlines in one colour, of robots that touch something or were chosen. */
  ring(context, pose, lens, robots, colour, width) {
    const path = new Path2D();
    for (const robot of robots) {
      for (const ring of this.outline(robot, pose, lens)) trace(path, ring);
    }
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke(path);
  }

  /** Robot at a place [px]; the nearest within some pixels, -1 for none. */
  at(pose, lens, [x, y], slack) {
    let best = -1;
    let least = Infinity;
    for (let robot = 0; robot < this.run.robots; robot++) {
      const dx = pose[3 * robot] * lens.scale + lens.x - x;
      const dy = lens.y - pose[3 * robot + 1] * lens.scale - y;
      const away = Math.hypot(dx, dy);
      if (away < least && away < Math.max(this.reach[robot] * lens.scale, slack)) {
        best = robot;
        least = away;
      }
    }
    return best;
  }
}

export function trace(path, ring) {
  for (let k = 0; k < ring.length; k += 2) {
    if (k) path.lineTo(ring[k], ring[k + 1]);
    else path.moveTo(ring[k], ring[k + 1]);
  }
  path.closePath();
}

/** Draws where robots went in the last seconds, fading; those of a crowd in one go. */
export function drawTrails(context, run, time, lens, seen, colourOf) {
  const from = Math.max(0, time - run.header.trail);
  if (time <= from || !seen.length) return;
  const { crowd } = run.header;
  const steps = crowd ? CROWD_STEPS : TRAIL_STEPS;
  const fades = crowd ? 1 : FADES;
  const lines = seen.map((robot) => trail(run, robot, from, time, steps, lens));
  context.lineWidth = crowd ? 1 : 2;
  for (let fade = 0; fade < fades; fade++) {
    const first = Math.floor((fade * steps) / fades);
    const last = Math.floor(((fade + 1) * steps) / fades);
    context.globalAlpha = (0.75 * (fade + 1)) / fades;
    if (crowd) context.beginPath();
    lines.forEach((line, k) => {
      if (!crowd) context.beginPath();
      context.moveTo(line[2 * first], line[2 * first + 1]);
      for (let at = first + 1; at <= last; at++) context.lineTo(line[2 * at], line[2 * at + 1]);
      if (crowd && k < lines.length - 1) return;
      context.strokeStyle = colourOf(seen[k]);
      context.stroke();
    });
  }
  context.globalAlpha = 1;
}

/** Places [px], flat, of a robot at so many steps between two times. */
function trail(run, robot, from, to, steps, lens) {
  const cursor = run.cursor[robot];
  const place = new Float64Array(3);
  const line = new Float64Array(2 * steps + 2);
  for (let k = 0; k <= steps; k++) {
    run.place(robot, from + ((to - from) * k) / steps, place, 0);
    line[2 * k] = place[0] * lens.scale + lens.x;
    line[2 * k + 1] = lens.y - place[1] * lens.scale;
  }
  run.cursor[robot] = cursor;
  return line;
}

const shades = new Map();

/** A colour "#rrggbb" with three fifths of black, as edges of robots have it. */
export function darker(colour) {
  if (!shades.has(colour)) {
    const parts = [1, 3, 5].map((k) => Math.round(parseInt(colour.slice(k, k + 2), 16) * 0.4));
    shades.set(colour, `rgb(${parts.join(" ")})`);
  }
  return shades.get(colour);
}

/** Closest points [m] of two robots: [[x, y], [x, y]]. */
export function closestPoints(fleet, pose, a, b) {
  const lens = { scale: 1, x: 0, y: 0 };
  const up = (ring) => ring.map((value, k) => (k % 2 ? -value : value));
  const [one, other] = [a, b].map((robot) => fleet.outline(robot, pose, lens).map(up));
  let best = null;
  let least = Infinity;
  const look = (corners, edges, swap) => {
    for (const ring of corners) {
      for (let k = 0; k < ring.length; k += 2) {
        for (const edge of edges) {
          for (let m = 0; m < edge.length; m += 2) {
            const n = (m + 2) % edge.length;
            const foot = nearestOn(ring[k], ring[k + 1], edge[m], edge[m + 1], edge[n], edge[n + 1]);
            const away = Math.hypot(foot[0] - ring[k], foot[1] - ring[k + 1]);
            if (away >= least) continue;
            least = away;
            const corner = [ring[k], ring[k + 1]];
            best = swap ? [foot, corner] : [corner, foot];
          }
        }
      }
    }
  };
  look(one, other, false);
  look(other, one, true);
  return best;
}

/** Whether a corner of one of two bodies lies in the other. */
export function overlap(fleet, pose, a, b) {
  const rings = [a, b].map((body) => fleet.outline(body, pose, { scale: 1, x: 0, y: 0 }));
  const holds = (x, y, ring) => {
    let inside = false;
    for (let k = 0, m = ring.length - 2; k < ring.length; m = k, k += 2) {
      const rises = ring[k + 1] > y !== ring[m + 1] > y;
      const share = (y - ring[k + 1]) / (ring[m + 1] - ring[k + 1]);
      if (rises && x < ring[k] + share * (ring[m] - ring[k])) inside = !inside;
    }
    return inside;
  };
  const meet = (corners, bodies) =>
    corners.some((ring) => bodies.some((other) => ring.some((x, k) => k % 2 === 0 && holds(x, ring[k + 1], other))));
  return meet(rings[0], rings[1]) || meet(rings[1], rings[0]);
}

export function nearestOn(x, y, ax, ay, bx, by) {
  const dx = bx - ax;
  const dy = by - ay;
  const square = dx * dx + dy * dy;
  const share = square ? Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / square)) : 0;
  return [ax + share * dx, ay + share * dy];
}

/** Whether a moment at which the least distances are known is another than a time, to the eye. */
export function isFar(run, now, time) {
  return Math.abs(run.now[now] * run.dt - time) > FAR;
}

/** The moment nearest to a time at which the least distances are known. */
export function nowAt(run, time) {
  run.now ??= run.array.whole("now");
  const step = (time + 1e-9) / run.dt;
  const k = Math.max(0, lastAtMost(run.now, step));
  return k + 1 < run.now.length && run.now[k + 1] - step < step - run.now[k] ? k + 1 : k;
}
