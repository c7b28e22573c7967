// Labels of a view: the least distance, and the names of robots, each beside its own.

import { line } from "./marks.js";
import { nearestOn } from "./robots.js";

const HIGH = 7; // [px] half the height of a label
const OWN = 3; // [px] by which a name must be nearer to its own robot than to any other
const FARTHER = [16, 32, 48]; // [px] at which a name with a line to its robot is tried

/** Length and ends [px] of the shortest way from a box about a place to an outline, flat rings. */
function way([x, y], half, outline) {
  let best = { length: Infinity };
  let isInside = false;
  const look = (from, to) => {
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (length < best.length) best = { length, from, to };
  };
  const corners = [[-half, -HIGH], [half, -HIGH], [half, HIGH], [-half, HIGH]];
  for (const ring of outline) {
    for (let k = 0; k < ring.length; k += 2) {
      const [ax, ay] = [ring[k], ring[k + 1]];
      const n = (k + 2) % ring.length;
      const [bx, by] = [ring[n], ring[n + 1]];
      if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) isInside = !isInside;
      look([ax, ay], [Math.min(x + half, Math.max(x - half, ax)), Math.min(y + HIGH, Math.max(y - HIGH, ay))]);
      for (const [cx, cy] of corners) {
        look(nearestOn(x + cx, y + cy, ax, ay, bx, by), [x + cx, y + cy]);
      }
    }
  }
  return isInside ? { ...best, length: 0 } : best;
}

/** Whether a name at a place would be read as that of its own robot. */
function isNearest(place, half, own, robots) {
  const bound = way(place, half, own.outline()).length + OWN;
  return robots.every((other) => {
    if (other.robot === own.robot) return true;
    const [x, y, reach] = other.disc; // none of the robot lies outside: most are told by it
    const away = Math.hypot(
      Math.max(Math.abs(place[0] - x) - half, 0), Math.max(Math.abs(place[1] - y) - HIGH, 0),
    );
    return away - reach >= bound || way(place, half, other.outline()).length >= bound;
  });
}

function isPast({ from, to }, [x, y, reach]) {
  const foot = nearestOn(x, y, ...from, ...to);
  return Math.hypot(foot[0] - x, foot[1] - y) > reach;
}

function round([x, y], half, up) {
  const [beside, corner] = [half + up, half + 0.6 * up];
  return [
    [x, y - up], [x, y + up], [x + beside, y], [x - beside, y],
    [x + corner, y - up], [x - corner, y - up], [x + corner, y + up], [x - corner, y + up],
  ];
}

/** Writes labels where they cover no label before them and, where there is room, none of the
 * robots, each with its disc [x, y, radius] and outline [px]. A name stands nearest to its own
 * robot; farther off it has a line to it, and without room for that it is left out. Returns the
 * lines. */
export function writeLabels(context, labels, colours, [width, height], robots) {
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  const taken = [];
  const written = [];
  const leaders = [];
  const fontOf = (bold) => `${bold ? "600 " : ""}12.5px system-ui, sans-serif`;
  for (const { words, x, y, up, bold, robot } of labels) {
    context.font = fontOf(bold);
    const half = context.measureText(words).width / 2 + 2;
    const at = (ups) => ups.flatMap((away) => round([x, y], half, away));
    const isClear = ([px, py]) => robots.every(({ disc: [ox, oy, reach] }) =>
      Math.hypot(Math.max(Math.abs(px - ox) - half, 0), Math.max(Math.abs(py - oy) - HIGH, 0)) > 0.7 * reach);
    const isFree = ([px, py]) =>
      px - half > 0 && px + half < width && py > 8 && py < height - 8 &&
      taken.every(([ox, oy, wide]) => Math.abs(px - ox) > half + wide || Math.abs(py - oy) > 14);
    const own = robots.find((one) => one.robot === robot);
    let place = null;
    if (!own) {
      const free = at(bold ? [up, up + 14, up + 28] : [up]).filter(isFree);
      place = free.find(isClear) ?? free[0] ?? (bold ? at([up])[0] : null);
    } else {
      const near = at([up]).filter((one) => isFree(one) && isNearest(one, half, own, robots));
      place = near.find(isClear) ?? near[0];
      if (!place) {
        const others = robots.filter((one) => one !== own);
        const leads = (one) => others.every(({ disc: [ox, oy, reach] }) =>
          isPast(way(one, half, own.outline()), [ox, oy, 0.7 * reach]));
        const far = at(FARTHER.map((more) => up + more)).filter(isFree);
        place = far.find((one) => isClear(one) && leads(one)) ?? (bold ? far[0] ?? at([up])[0] : null);
        if (place) leaders.push({ words, ...way(place, half, own.outline()) });
      }
    }
    if (!place) continue;
    taken.push([...place, half]);
    written.push({ words, place, bold });
  }
  for (const { from, to } of leaders) {
    line(context, from, to, colours.floor, 3);
    line(context, from, to, colours.ink, 1);
  }
  for (const { words, place, bold } of written) {
    context.font = fontOf(bold);
    context.strokeStyle = colours.floor;
    context.lineWidth = 3.5;
    context.strokeText(words, ...place);
    context.fillStyle = colours.ink;
    context.fillText(words, ...place);
  }
  return leaders;
}
