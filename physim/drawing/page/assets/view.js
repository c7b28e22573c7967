// A run on a canvas: draws it at a time, as its camera sees it, and knows what lies under a finger.

import { Camera, toPixels } from "./camera.js";
import { Contacts } from "./contacts.js";
import { DASHES } from "./courses.js";
import { fitted } from "./dom.js";
import { Ground } from "./ground.js";
import { drawClosest, drawContacts, drawScale, drawSight, drawTargets } from "./marks.js";
import { writeLabels } from "./names.js";
import { Fleet, closestPoints, drawTrails, isFar, nowAt, overlap } from "./robots.js";
import { roundBelow } from "./words.js";

const CONTACT_LASTS = 1; // [s] least simulated time that the mark of a contact stays
const FINGER = 16; // [px]
const OVERVIEW = 0.2; // share of the view's shorter side
const PALE = 0.3; // of the overview over robots
const FEW = 60; // robots that all have names, targets and trails of their own

export class View {
  constructor(run, canvas) {
    this.run = run;
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    if (!this.context) throw new Error("this browser draws no canvas");
    this.ground = new Ground(run);
    this.fleet = new Fleet(run);
    this.contacts = new Contacts(run);
    this.camera = new Camera(run);
    this.ghosts = []; // other views, drawn as outlines in this one
    this.drawn = null; // what was drawn last: time, poses and lens
  }

  /** The closest two robots at a time, as they were recorded, or far from a sample as they are drawn;
   * two that touch between two samples come first. Null without. */
  closest(time) {
    const { run } = this;
    if (!run.header.curves.pair) return null;
    this.pairs ??= ["now_pair", "now_a", "now_b"].map((name) => run.array(name));
    const now = nowAt(run, time);
    const [distance, a, b] = this.pairs.map((values) => values[now]);
    const isGraze = ({ k, touches, swept }) => touches && swept && this.contacts.b[k] < run.moving;
    const graze = this.contacts.shown(time).find(isGraze);
    if (!graze && !isFar(run, now, time)) return { a, b, distance };
    const two = graze ? this.contacts.bodies(graze.k) : [a, b];
    const isThere = graze && Math.abs(time - this.contacts.time(graze.k)) <= 0.1 * run.dt;
    const pose = run.poses(time);
    const [from, to] = closestPoints(this.fleet, pose, ...two);
    const touch = isThere || overlap(this.fleet, pose, ...two);
    return { a: two[0], b: two[1], distance: touch ? 0 : Math.hypot(to[0] - from[0], to[1] - from[1]) };
  }

  modeColour(robot, time, colours) {
    const { run } = this;
    if (robot >= run.robots) return colours[run.kind(robot)];
    const mode = run.modesAt(time)[robot];
    if (mode >= 0) return run.modes[mode].colour;
    if (!run.header.modeless) return colours.undecided;
    return run.header.crowd ? colours.band : colours.robots[robot % colours.robots.length];
  }

  draw(time, { colours, speed, chosen, layers }) {
    const { run, context, camera } = this;
    fitted(this.canvas);
    const ratio = window.devicePixelRatio || 1;
    const size = [this.canvas.width / ratio, this.canvas.height / ratio];
    camera.resize(...size);
    const at = Math.min(time, run.duration);
    const lens = camera.lens(at);
    const pose = run.poses(at);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = colours.outside;
    context.fillRect(0, 0, ...size);
    this.ground.draw(context, lens, colours);
    const there = this.inSight(pose, lens, size);
    const seen = there.filter((body) => body < run.robots);
    const moved = there.slice(seen.length);
    const few = run.robots <= FEW;
    const own = (robot) => (few ? colours.robots[robot % colours.robots.length] : colours.band);
    if (layers.trails) drawTrails(context, run, at, lens, seen, own);
    if (layers.targets && few && run.targets) {
      drawTargets(context, run, pose, at, lens, seen, colours);
    }
    this.ghosts.forEach((ghost, k) => {
      ghost.drawGhost(context, time, lens, size, colours, DASHES[k + 1]);
    });
    this.fleet.draw(context, pose, lens, moved, (body) => this.modeColour(body, at, colours));
    this.fleet.ring(context, pose, lens, moved, colours.wall, 2);
    this.fleet.draw(context, pose, lens, seen, (robot) => this.modeColour(robot, at, colours));
    this.fleet.drawWheels(context, pose, lens, seen, at, (robot) => this.modeColour(robot, at, colours));
    this.drawReferencePoints(context, pose, lens, seen, colours);
    const shown = this.contacts.shown(at, Math.max(CONTACT_LASTS, 0.5 * speed));
    const touching = new Set(
      shown.filter((one) => one.touches).flatMap(({ k }) => this.contacts.bodies(k)),
    );
    const inView = new Set(there);
    const among = [...touching].filter((robot) => inView.has(robot));
    this.fleet.ring(context, pose, lens, among, colours.contact, 3);
    const labels = [];
    const pair = this.closest(at);
    if (pair && inView.has(pair.a) && inView.has(pair.b)) {
      labels.push(drawClosest(context, this.fleet, pose, lens, pair, colours));
    }
    if (chosen >= 0) {
      drawSight(context, run, chosen, at, pose, lens, colours);
      if (!few && run.targets) drawTargets(context, run, pose, at, lens, [chosen], colours);
      this.fleet.ring(context, pose, lens, [chosen], colours.paper, 5);
      this.fleet.ring(context, pose, lens, [chosen], colours.ink, 2.5);
    }
    drawContacts(context, shown, lens, colours, speed, run.header.crowd);
    if (layers.names) {
      const named = few ? (moved.length <= FEW ? there : seen) : [...new Set([pair?.a, pair?.b, ...among.slice(0, 12), chosen])];
      for (const robot of named) {
        if (inView.has(robot)) labels.push(this.nameOf(robot, pose, lens, robot === chosen));
      }
    }
    const robots = layers.names || few ? there.map((robot) => this.placed(robot, pose, lens)) : [];
    writeLabels(context, labels, colours, size, robots);
    drawScale(context, roundBelow(130 / lens.scale), lens, size[1], colours);
    if (lens.scale > 1.25 * camera.wholeScale) this.drawOverview(context, pose, lens, at, size, colours, seen);
    this.drawn = { time: at, pose: pose.slice(), lens, ratio, shown, size };
  }

  /** All that moves and is in a view of some size, robots first. */
  inSight(pose, lens, size) {
    const bodies = [...this.fleet.shape.keys()];
    return bodies.filter((body) => this.fleet.isSeen(body, pose, lens, size));
  }

  discOf(robot, pose, lens) {
    const place = toPixels(lens, pose[3 * robot], pose[3 * robot + 1]);
    return [...place, this.fleet.reach[robot] * lens.scale];
  }

  /** A robot as labels see it; its outline is worked out when it is asked for. */
  placed(robot, pose, lens) {
    let found = null;
    const outline = () => (found ??= this.fleet.outline(robot, pose, lens));
    return { robot, disc: this.discOf(robot, pose, lens), outline };
  }

  nameOf(robot, pose, lens, isChosen) {
    const [x, y] = toPixels(lens, pose[3 * robot], pose[3 * robot + 1]);
    const name = this.run.names[robot];
    const words = (name.length > 18 ? `${name.slice(0, 17)}…` : name) + (this.run.marks[robot] ?? "");
    return { words, x, y, up: this.fleet.reach[robot] * lens.scale * (robot < this.run.robots ? 0.8 : 1) + 9, bold: isChosen, robot };
  }

  /** Marks the points that robots are steered by where they lie far from their middle. */
  drawReferencePoints(context, pose, lens, seen, colours) {
    for (const robot of seen) {
      if (!this.fleet.shapes[this.fleet.shape[robot]].eccentric) continue;
      const [x, y] = toPixels(lens, pose[3 * robot], pose[3 * robot + 1]);
      context.fillStyle = colours.ink;
      context.beginPath();
      context.arc(x, y, Math.min(2.2, 0.15 * lens.scale), 0, 7);
      context.fill();
    }
  }

  /** The robots of this run as outlines in the view of another. */
  drawGhost(context, time, lens, size, colours, dash) {
    const { run } = this;
    const at = Math.min(time, run.duration);
    const pose = run.poses(at);
    const seen = this.inSight(pose, lens, size);
    const colourOf = (robot) => this.modeColour(robot, at, colours);
    this.fleet.draw(context, pose, lens, seen, colourOf, { ghost: true, dash });
    drawContacts(context, this.contacts.shown(at, CONTACT_LASTS), lens, colours, 0, true);
  }

  /** The whole scene, small, with the part that the view shows; pale where it lies over robots. */
  drawOverview(context, pose, lens, time, [width, height], colours, seen) {
    const { low, high } = this.camera;
    const [wide, high_] = [high[0] - low[0], high[1] - low[1]];
    const room = Math.max(90, OVERVIEW * Math.min(width, height) * 1.4);
    const scale = Math.min(room / wide, room / high_);
    const box = [wide * scale + 10, high_ * scale + 10];
    const [left, top] = [width - box[0] - 10, 10];
    const small = { scale, x: left + 5 - low[0] * scale, y: top + 5 + high[1] * scale };
    context.save();
    const hides = seen.some((robot) => {
      const [x, y, radius] = this.discOf(robot, pose, lens);
      return x + 0.7 * radius > left && y - 0.7 * radius < top + box[1];
    });
    context.globalAlpha = hides ? PALE : 1;
    context.beginPath();
    context.rect(left, top, ...box);
    context.fillStyle = colours.outside;
    context.fill();
    context.clip();
    this.ground.drawPlain(context, small, colours);
    for (let robot = 0; robot < this.run.moving; robot++) {
      const [x, y] = toPixels(small, pose[3 * robot], pose[3 * robot + 1]);
      context.fillStyle = this.modeColour(robot, time, colours);
      context.fillRect(x - 1.5, y - 1.5, 3, 3);
    }
    const k = scale / lens.scale;
    context.strokeStyle = colours.ink;
    context.lineWidth = 1.2;
    context.strokeRect(small.x - lens.x * k, small.y - lens.y * k, width * k, height * k);
    context.restore();
    context.strokeStyle = colours.rule;
    context.strokeRect(left, top, ...box);
  }

  /** What lies at a place [px] of what was drawn last: a contact, a robot, or nothing. */
  under([x, y]) {
    if (!this.drawn) return {};
    const { lens, pose, shown } = this.drawn;
    for (const one of [...shown].reverse()) {
      const [px, py] = toPixels(lens, one.x, one.y);
      if (Math.hypot(px - x, py - y) < FINGER) return { contact: one.k };
    }
    const robot = this.fleet.at(pose, lens, [x, y], FINGER);
    return robot < 0 ? {} : { robot };
  }
}
