// What part of the world a view shows: all of it, the robots, or one robot; zoomed and moved by hand.

const PAD = 28; // [px]
const LOOKS = 60; // moments at which the size of the group is taken
const NEAR = 2.6; // times its range, shown round a robot that is followed
const CLOSE = 7; // times the largest robot's reach, shown round a contact
const USUAL_RANGE = 10; // times the largest robot's reach, where no range is known
const LONGEST_RANGE = 30; // times that reach: of a longer range the robot would be a dot
const LEAST = 16; // times that reach, at least to be seen of the world when the robots are followed
const ROUND = 4; // times that reach, of room round them
const WHOLE_SHARE = 0.72; // of the scene, from which the group's part is no closer look
const MOST_UNLIKE = 3; // times as large may be what one scale shows beside another
const SMOOTH = 1.0; // [s] before and after, over which the place of the group is averaged

export class Camera {
  constructor(run) {
    this.run = run;
    this.follow = "robots";
    this.close = false; // whether a robot is followed from close by
    this.zoom = 1;
    this.shift = [0, 0]; // [m] by hand
    this.size = [1, 1];
    [this.low, this.high] = run.header.scene.extent;
    this.whole = [0, 1].map((axis) => this.high[axis] - this.low[axis]); // [m] that must be seen
    this.reach = largestReach(run);
    this.group = groupSize(run, this.reach);
    this.scratch = new Float64Array(3 * run.robots);
  }

  resize(width, height) {
    this.size = [width, height];
  }

  /** Scale [px/m] at which a part of the world, width and height [m], fits. */
  scaleFor(width, height) {
    const [wide, high] = this.size.map((pixels) => Math.max(pixels - 2 * PAD, 40));
    return Math.min(wide / Math.max(width, 1e-3), high / Math.max(height, 1e-3));
  }

  get wholeScale() {
    return this.scaleFor(...this.whole);
  }

  /** Whether following the robots would show little less than everything. */
  get showsAll() {
    return this.wholeScale > WHOLE_SHARE * this.scaleFor(...this.group);
  }

  /** World to pixels of the view at a time: scale [px/m] and the world's origin [px], y down. */
  lens(time) {
    const [scale, [x, y]] = this.aim(time);
    const zoomed = scale * this.zoom;
    return {
      scale: zoomed,
      x: this.size[0] / 2 - (x + this.shift[0]) * zoomed,
      y: this.size[1] / 2 + (y + this.shift[1]) * zoomed,
    };
  }

  aim(time) {
    if (typeof this.follow === "number") {
      this.run.place(this.follow, time, this.scratch, 0);
      const range = this.run.header.range ?? USUAL_RANGE * this.reach;
      const far = NEAR * Math.min(range, LONGEST_RANGE * this.reach);
      const near = this.close ? CLOSE * this.reach : far;
      const scale = Math.max(this.scaleFor(near, near), this.wholeScale);
      return [scale, [this.scratch[0], this.scratch[1]]];
    }
    const middle = [0, 1].map((axis) => (this.low[axis] + this.high[axis]) / 2);
    if (this.follow === "whole" || this.showsAll) return [this.wholeScale, middle];
    return [this.scaleFor(...this.group), this.middleOfRobots(time)];
  }

  middleOfRobots(time) {
    const moments = [-SMOOTH, -SMOOTH / 2, 0, SMOOTH / 2, SMOOTH];
    const sum = [0, 0];
    for (const offset of moments) {
      const at = Math.min(Math.max(time + offset, 0), this.run.duration);
      const [low, high] = boxOf(this.run, at, this.scratch);
      sum[0] += (low[0] + high[0]) / 2;
      sum[1] += (low[1] + high[1]) / 2;
    }
    return sum.map((value) => value / moments.length);
  }

  /** Zooms by a factor about a place [px] of the view, which stays where it is. */
  zoomAt(factor, pixel, time) {
    const before = toWorld(this.lens(time), pixel);
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.2), 400);
    const after = toWorld(this.lens(time), pixel);
    this.shift = this.shift.map((value, axis) => value + before[axis] - after[axis]);
  }

  pan(dx, dy, time) {
    const { scale } = this.lens(time);
    this.shift = [this.shift[0] - dx / scale, this.shift[1] + dy / scale];
  }

  /** Looks at something else, without zoom or shift by hand. */
  look(follow, close = false) {
    Object.assign(this, { follow, close, zoom: 1, shift: [0, 0] });
  }

  /** Same look as another camera has. */
  copy(other) {
    Object.assign(this, { follow: other.follow, close: other.close, zoom: other.zoom, shift: [...other.shift] });
    if (typeof this.follow === "number" && this.follow >= this.run.moving) this.follow = "robots";
  }
}

/** Gives cameras of runs that are shown side by side one scale, if none is far too small for it. */
export function agree(cameras) {
  for (const what of ["whole", "group"]) {
    const sizes = cameras.map((camera) => camera[what]);
    const largest = [0, 1].map((axis) => Math.max(...sizes.map((size) => size[axis])));
    const least = [0, 1].map((axis) => Math.min(...sizes.map((size) => size[axis])));
    if (largest.some((size, axis) => size > MOST_UNLIKE * least[axis])) continue;
    for (const camera of cameras) camera[what] = largest;
  }
}

export const toWorld = (lens, [x, y]) => [(x - lens.x) / lens.scale, (lens.y - y) / lens.scale];

export const toPixels = (lens, x, y) => [x * lens.scale + lens.x, lens.y - y * lens.scale];

function boxOf(run, time, scratch) {
  run.poses(time, scratch);
  const low = [Infinity, Infinity];
  const high = [-Infinity, -Infinity];
  for (let k = 0; k < scratch.length; k += 3) {
    for (const axis of [0, 1]) {
      low[axis] = Math.min(low[axis], scratch[k + axis]);
      high[axis] = Math.max(high[axis], scratch[k + axis]);
    }
  }
  return [low, high];
}

/** Distance [m] of the farthest point of any robot from the point that it is steered by. */
function largestReach({ robots, header: { scene } }) {
  const shapes = scene.shape.slice(0, robots).map((number) => scene.shapes[number]);
  const points = shapes.flatMap(({ rings }) => rings.flat());
  return points.reduce((most, [x, y]) => Math.max(most, Math.hypot(x, y)), 1e-3);
}

/** Width and height [m] of the group at nearly all times, with room round it. */
function groupSize(run, reach) {
  const scratch = new Float64Array(3 * run.robots);
  const sizes = Array.from({ length: LOOKS }, (_, k) => {
    const [low, high] = boxOf(run, run.begin + ((run.duration - run.begin) * k) / (LOOKS - 1), scratch);
    return [high[0] - low[0], high[1] - low[1]];
  });
  return [0, 1].map((axis) => {
    const ordered = sizes.map((size) => size[axis]).sort((a, b) => a - b);
    return Math.max(ordered[Math.floor(0.95 * (LOOKS - 1))] + ROUND * reach, LEAST * reach);
  });
}
