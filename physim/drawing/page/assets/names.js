// Labels of a view: the least distance, and the names of robots, each beside its own.

import { nearestOn } from "./robots.js";

const HIGH = 7; // [px] half the height of a label
const OWN = 3; // [px] by which a name must be nearer to its own robot than to any other

const beyond = ([x, y], half, px, py) =>
  Math.hypot(Math.max(Math.abs(px - x) - half, 0), Math.max(Math.abs(py - y) - HIGH, 0));

/** Distance [px] of a label about a place to an outline, flat rings. */
function away(place, half, outline) {
  let least = Infinity;
  for (const ring of outline) {
    for (let k = 0; k < ring.length; k += 2) {
      const n = (k + 2) % ring.length;
      const foot = nearestOn(...place, ring[k], ring[k + 1], ring[n], ring[n + 1]);
      least = Math.min(least, beyond(place, half, ...foot));
    }
  }
  return least;
}

/** Whether a name at a place covers no robot and would be read as that of its own. */
function isClear(place, half, own, robots) {
  const bound = own ? away(place, half, own.outline()) + OWN : 0;
  return robots.every((other) => {
    const [x, y, reach] = other.disc; // none of the robot lies outside: most are told by it
    const gap = beyond(place, half, x, y);
    if (gap <= 0.7 * reach) return false;
    return other === own || gap - reach >= bound || away(place, half, other.outline()) >= bound;
  });
}

/** Writes labels where they cover neither robots, each with its disc [x, y, radius] and outline
 * [px], nor labels before them; bold ones in any case. */
export function writeLabels(context, labels, colours, [width, height], robots) {
  Object.assign(context, { textAlign: "center", textBaseline: "middle", lineJoin: "round" });
  const taken = [];
  for (const { words, x, y, up, bold, robot } of labels) {
    context.font = `${bold ? "600 " : ""}12.5px system-ui, sans-serif`;
    const half = context.measureText(words).width / 2 + 2;
    const own = robots.find((one) => one.robot === robot);
    const isFree = ([px, py]) =>
      px - half > 0 && px + half < width && py > 8 && py < height - 8 &&
      taken.every(([ox, oy, wide]) => Math.abs(px - ox) > half + wide || Math.abs(py - oy) > 14);
    const aside = half + up;
    const places = [[x, y - up], [x, y + up], [x + aside, y], [x - aside, y]];
    const place = places.find((one) => isFree(one) && isClear(one, half, own, robots)) ?? (bold ? places[0] : null);
    if (!place) continue;
    taken.push([...place, half]);
    Object.assign(context, { strokeStyle: colours.floor, fillStyle: colours.ink, lineWidth: 3.5 });
    context.strokeText(words, ...place);
    context.fillText(words, ...place);
  }
}
