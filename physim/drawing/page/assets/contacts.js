// Contacts of a run: which are there at a time, where, and what is told of them.

import { lastAtMost, starts } from "./run.js";

const SLACK = 1e-9;

export class Contacts {
  constructor(run) {
    this.run = run;
    this.told = run.header.contacts.told;
    const { array } = run;
    this.began = array.whole("contact_step");
    this.times = array("contact_time");
    this.samples = array.whole("contact_samples");
    this.a = array.whole("contact_a");
    this.b = array.whole("contact_b");
    this.swept = array.whole("contact_swept");
    this.deep = array.whole("contact_deep");
    this.first = starts(array.whole("contact_places"));
    this.placeStep = array.whole("place_step");
    this.x = array("place_x");
    this.y = array("place_y");
    this.longest = this.samples.reduce((longest, one) => Math.max(longest, one), 0);
  }

  get length() {
    return this.began.length;
  }

  /** How many began at or before a time [s]. */
  count(time) {
    return lastAtMost(this.began, (time + SLACK) / this.run.dt) + 1;
  }

  /** Those in which bodies touch at a time, and those that began at most `lasts` seconds before. */
  shown(time, lasts = 0) {
    const step = (time + SLACK) / this.run.dt;
    const end = this.count(time);
    const earliest = step - Math.max(this.longest, lasts / this.run.dt);
    const found = [];
    for (let k = Math.max(0, lastAtMost(this.began, earliest)); k < end; k++) {
      const touches = this.began[k] + this.samples[k] > step;
      const age = (step - this.began[k]) * this.run.dt;
      if (touches || age < lasts) {
        const place = this.place(k, step);
        const deep = this.deep[k] >= 0 && this.deep[k] <= step;
        found.push({ k, touches, age, swept: this.swept[k] === 1, deep, ...place });
      }
    }
    return found;
  }

  place(k, step) {
    const at = lastAtMost(this.placeStep, step, this.first[k], this.first[k + 1]);
    const row = Math.max(at, this.first[k]);
    return { x: this.x[row], y: this.y[row] };
  }

  /** When it began; of one between two samples, when the two are closest [s]. */
  time(k) {
    return this.times[k];
  }

  bodies(k) {
    return [this.a[k], this.b[k]];
  }

  /** Numbers of the contacts of a robot. */
  of(robot) {
    const found = [];
    for (let k = 0; k < this.length; k++) {
      if (this.a[k] === robot || this.b[k] === robot) found.push(k);
    }
    return found;
  }
}
