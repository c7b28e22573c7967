// The time that is shown: it plays, stands, and is set by hand. Frames are counted and timed.

const KEPT = 600; // frames whose times are kept

export class Player {
  constructor(begin, duration, speed, show) {
    Object.assign(this, { begin, duration, speed, show });
    this.time = begin;
    this.playing = false;
    this.listeners = [];
    this.frames = []; // [ms] from each frame to the next while it plays
    this.work = []; // [ms] that drawing each took
    this.last = null;
    this.asked = false;
  }

  onChange(listener) {
    this.listeners.push(listener);
  }

  changed() {
    for (const listener of this.listeners) listener(this);
  }

  play() {
    if (this.time >= this.duration) this.time = this.begin;
    this.playing = true;
    this.last = null;
    this.changed();
    this.draw();
  }

  pause() {
    this.playing = false;
    this.changed();
    this.draw();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  /** Shows another time [s], within the run. */
  seek(time) {
    this.time = Math.min(Math.max(Number.isFinite(time) ? time : this.begin, this.begin), this.duration);
    this.last = null;
    this.changed();
    this.draw();
  }

  setSpeed(speed) {
    this.speed = speed;
    this.changed();
  }

  /** Asks for one frame; however often, one is drawn. */
  draw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame((now) => this.frame(now));
  }

  frame(now) {
    this.asked = false;
    if (this.playing) {
      if (this.last !== null) {
        this.time = Math.min(this.time + ((now - this.last) / 1000) * this.speed, this.duration);
        keep(this.frames, now - this.last);
      }
      this.last = now;
      if (this.time >= this.duration) {
        this.playing = false;
        this.changed();
      } else {
        this.draw();
      }
    }
    const begin = performance.now();
    this.show(this.time);
    if (this.playing) keep(this.work, performance.now() - begin);
  }
}

function keep(list, value) {
  list.push(value);
  if (list.length > KEPT) list.shift();
}
