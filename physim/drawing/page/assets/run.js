// One run: where its robots are and what they had decided at any time.

const NO_TURN = 1e-3; // as in physim/drawing/page/knots.py
const SLACK = 1e-9; // [s] a decision at a moment counts at that moment

export class Run {
  constructor({ header, array }, number) {
    Object.assign(this, { header, number, array });
    this.dt = header.dt;
    this.robots = header.robots;
    this.begin = header.begin;
    this.duration = header.duration;
    this.names = header.scene.bodies.map((body) => body.name);
    this.marks = header.marks; // of who drives each robot, behind its name
    this.modes = header.modes;
    this.knots = starts(array.whole("knots"));
    this.moving = this.knots.length - 1; // bodies that move: robots first, then movers and what is pushed
    this.knotStep = array.whole("knot_step");
    this.knot = ["x", "y", "heading"].map((name) => array(`knot_${name}`));
    this.cursor = new Int32Array(this.moving);
    this.pose = new Float64Array(3 * this.moving);
    this.first = starts(array.whole("decisions"));
    this.step = array.whole("step");
    this.hold = array.whole("hold");
    this.mode = array.whole("mode");
    this.rule = array.whole("rule");
    this.arrivedStep = array.whole("arrived");
    this.columns = new Map();
    this.targets = array.has("own:target_x") && array.has("own:target_y");
  }

  /** A column of the decisions, NaN in all rows where there is none. */
  column(name) {
    if (!this.columns.has(name)) {
      const there = this.array.has(name);
      this.columns.set(name, there ? this.array(name) : new Float64Array(this.step.length).fill(NaN));
    }
    return this.columns.get(name);
  }

  /** Puts the poses (x, y, heading of each body) at a time [s] into `out`, or its own array; as many
   * as it has room for. */
  poses(time, out = this.pose) {
    for (let body = 0; 3 * body < out.length; body++) this.place(body, time, out, 3 * body);
    return out;
  }

  /** Puts the pose of one robot at `out[at]` and behind. */
  place(robot, time, out, at) {
    const [x, y, heading] = this.knot;
    const step = time / this.dt;
    const k = this.knotBefore(robot, step);
    const last = this.knots[robot + 1] - 1;
    if (k === last || step <= this.knotStep[k]) {
      out[at] = x[k];
      out[at + 1] = y[k];
      out[at + 2] = heading[k];
      return;
    }
    const share = (step - this.knotStep[k]) / (this.knotStep[k + 1] - this.knotStep[k]);
    const turn = heading[k + 1] - heading[k];
    const dx = x[k + 1] - x[k];
    const dy = y[k + 1] - y[k];
    let c = share;
    let s = 0;
    if (Math.abs(turn) > NO_TURN && Math.abs(turn) < Math.PI) {
      const half = turn / 2;
      const length = Math.sin(half * share) / Math.sin(half);
      c = length * Math.cos(half * (share - 1));
      s = length * Math.sin(half * (share - 1));
    }
    out[at] = x[k] + c * dx - s * dy;
    out[at + 1] = y[k] + s * dx + c * dy;
    out[at + 2] = heading[k] + turn * share;
  }

  /** The last knot of a robot at or before a step; found from the one that was asked for last. */
  knotBefore(robot, step) {
    const first = this.knots[robot];
    const end = this.knots[robot + 1];
    let k = first + this.cursor[robot];
    const near = this.knotStep[k] <= step && (k + 2 >= end || this.knotStep[k + 2] > step);
    if (near) {
      if (k + 1 < end && this.knotStep[k + 1] <= step) k += 1;
    } else {
      k = Math.max(first, lastAtMost(this.knotStep, step, first, end));
    }
    this.cursor[robot] = k - first;
    return k;
  }

  /** Key of the colour of a body: that of its kind, beside robots. */
  kind(body) {
    return this.header.scene.bodies[body].kind;
  }

  /** Row of a robot's last decision at or before a time [s]; -1 before its first. */
  decision(robot, time) {
    const row = lastAtMost(this.step, (time + SLACK) / this.dt, this.first[robot], this.first[robot + 1]);
    return row < this.first[robot] ? -1 : row;
  }

  /** Numbers of all modes at a time, -1 where there is none; kept until another is asked for. */
  modesAt(time) {
    if (this.modesTime === time) return this.modesNow;
    this.modesNow ??= new Int32Array(this.robots);
    this.modesTime = time;
    for (let robot = 0; robot < this.robots; robot++) {
      const row = this.decision(robot, time);
      this.modesNow[robot] = row < 0 ? -1 : this.mode[row];
    }
    return this.modesNow;
  }

  /** Whether all robots have arrived. */
  finished(time) {
    const step = (time + SLACK) / this.dt;
    return this.arrivedStep.every((at) => at >= 0 && at <= step);
  }

  /** Robots that were considered in a decision; null where the page does not have them. */
  considered(row) {
    if (!this.header.decisions.others || row < 0) return null;
    if (!this.others) {
      this.others = this.array.whole("others");
      this.othersStart = starts(this.array.whole("others_count"));
      let set = -1;
      this.othersSet = Int32Array.from(this.array.whole("others_new"), (isNew) => (set += isNew));
    }
    const set = this.othersSet[row];
    return [...this.others.subarray(this.othersStart[set], this.othersStart[set + 1])];
  }

  /** Commands of a robot at a time: nominal, filtered, applied, each [v, omega], with the lateral
   * speed last where robots have any; kept [s] how exact. */
  commands(robot, time) {
    const row = this.decision(robot, time);
    const parts = ["v", "omega", "lateral"].filter((part) => this.array.has(`nominal_${part}`));
    const own = parts.map((part) => (row < 0 ? 0 : this.column(`nominal_${part}`)[row]));
    const apart = this.header.decisions.commands;
    const found = { nominal: own, filtered: own, applied: own, apart };
    if (apart < 0) return found;
    this.commandRobot ??= this.array.whole("command_robot");
    this.commandStep ??= this.array.whole("command_step");
    const low = lastAtMost(this.commandRobot, robot - 1, 0, this.commandRobot.length) + 1;
    const high = lastAtMost(this.commandRobot, robot, 0, this.commandRobot.length) + 1;
    const step = Math.floor((time + SLACK) / this.dt);
    const at = lastAtMost(this.commandStep, step, low, high);
    const old = Math.max(0, Math.round(apart / this.dt) - 1);
    if (at < low || this.commandStep[at] < step - old) return found;
    for (const stage of ["nominal", "filtered", "applied"]) {
      found[stage] = parts.map((part) => this.column(`command:${stage}_${part}`)[at]);
    }
    return found;
  }

  /** Angle of the front wheels of a robot at a time [rad], left positive; 0 where none is known. */
  steering(robot, time) {
    if (!this.header.steers) return 0;
    this.steered ??= { steps: this.array.whole("steering_step"), angles: this.array("steering") };
    const { steps, angles } = this.steered;
    const k = Math.max(0, lastAtMost(steps, (time + SLACK) / this.dt));
    return angles[robot * steps.length + k];
  }

  /** Spans of one mode each of a robot, [from, to, mode] in seconds. */
  spans(robot) {
    const found = [];
    for (let row = this.first[robot]; row < this.first[robot + 1]; row++) {
      const time = this.step[row] * this.dt;
      const last = found.at(-1);
      if (!last || last[2] !== this.mode[row]) found.push([time, time, this.mode[row], row]);
      if (last) last[1] = Math.max(last[1], found.at(-1)[0]);
    }
    if (found.length) found.at(-1)[1] = this.duration;
    return found;
  }
}

/** Where each of so many begins, and the end of the last. */
export function starts(counts) {
  const found = new Int32Array(counts.length + 1);
  counts.forEach((count, k) => (found[k + 1] = found[k] + count));
  return found;
}

/** Last place from `low` to before `high` with a number of at most `value`; low - 1 without. */
export function lastAtMost(numbers, value, low = 0, high = numbers.length) {
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}
