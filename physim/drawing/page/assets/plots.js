// Courses over time below the view; the line across all of them is the time, and can be dragged.

import { fitted } from "./dom.js";
import { courses } from "./courses.js";
import { drawContact } from "./marks.js";
import { roundAbove, roundBelow, tick } from "./words.js";

const LEFT = 52; // [px] for numbers
const RIGHT = 12;
const AXIS = 18;
const HEAD = 15;
const TICK = 13; // [px] from tick to tick at least
const APART = 4; // [px] from mark to mark on the time axis at least

export class Plots {
  /** `seek` is called with a time [s] while the line is dragged. */
  constructor(canvas, runs, begin, duration, seek) {
    Object.assign(this, { canvas, runs, begin, duration });
    this.context = canvas.getContext("2d");
    this.still = document.createElement("canvas");
    this.rows = courses(runs);
    this.key = "";
    const drag = (event) => {
      const box = canvas.getBoundingClientRect();
      const share = (event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
      seek(begin + Math.min(Math.max(share, 0), 1) * (duration - begin));
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      drag(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons && canvas.hasPointerCapture(event.pointerId)) drag(event);
    });
  }

  draw(time, { colours, scheme, active, chosen }) {
    const { canvas, context } = this;
    const key = `${scheme} ${active} ${chosen}`;
    if (fitted(canvas) || key !== this.key) {
      this.key = key;
      this.drawStill(colours, active, chosen);
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.still, 0, 0);
    const ratio = window.devicePixelRatio || 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const x = this.x(time);
    context.strokeStyle = colours.ink;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(x, 2);
    context.lineTo(x, this.height - AXIS + 3);
    context.stroke();
    context.fillStyle = colours.ink;
    context.beginPath();
    context.arc(x, this.height - AXIS + 3, 4, 0, 7);
    context.fill();
  }

  get width() {
    return this.canvas.width / (window.devicePixelRatio || 1);
  }

  get height() {
    return this.canvas.height / (window.devicePixelRatio || 1);
  }

  x(time) {
    const lasts = this.duration - this.begin;
    return LEFT + (this.width - LEFT - RIGHT) * (lasts ? (time - this.begin) / lasts : 0);
  }

  drawStill(colours, active, chosen) {
    this.still.width = this.canvas.width;
    this.still.height = this.canvas.height;
    const context = this.still.getContext("2d");
    const ratio = window.devicePixelRatio || 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = colours.paper;
    context.fillRect(0, 0, this.width, this.height);
    const all = this.rows.reduce((sum, row) => sum + row.share, 0);
    let top = 2;
    for (const row of this.rows) {
      const high = ((this.height - AXIS - 2) * row.share) / all;
      this.drawRow(context, row, top, high, colours, active, chosen);
      top += high;
    }
    this.drawAxis(context, colours);
    this.drawContacts(context, colours, this.runs[active]);
  }

  drawRow(context, row, top, high, colours, active, chosen) {
    const box = { left: LEFT, top: top + HEAD, width: this.width - LEFT - RIGHT, height: high - HEAD - 4 };
    const run = this.runs[active];
    Object.assign(context, { font: "11.5px system-ui, sans-serif", textAlign: "left", textBaseline: "alphabetic" });
    context.fillStyle = colours.quiet;
    const title = row.title + (row.ofOne && this.runs.length > 1 ? `, ${run.label}` : "");
    const whole = [title, row.note].filter(Boolean).join("; ");
    const fits = context.measureText(whole).width <= box.width;
    context.fillText(fits ? whole : title, LEFT, top + 11, box.width);
    const names = run.marks.map((mark, robot) => run.names[robot] + mark);
    if (row.named) this.nameLines(context, names, LEFT + context.measureText(`${title}  `).width, top + 11, colours);
    if (box.height < 6) return;
    context.fillStyle = colours.faint;
    context.fillRect(box.left, box.top, box.width, box.height);
    const frame = { ...box, limits: row.limits, x: (time) => this.x(time) };
    if (row.limits) {
      const [low, top_] = row.limits;
      frame.y = (value) =>
        box.top + box.height * (1 - (Math.min(Math.max(value, low), top_) - low) / (top_ - low));
      this.drawTicks(context, frame, colours);
    }
    context.save();
    context.beginPath();
    context.rect(box.left, box.top - 1, box.width, box.height + 2);
    context.clip();
    row.draw(context, frame, { colours, active, chosen });
    context.restore();
    if (row.ofOne && !row.limits) this.nameRows(context, run, frame, colours);
  }

  /** Names of the robots in the colours of their lines, after the title. */
  nameLines(context, names, x, y, colours) {
    names.forEach((name, k) => {
      const wide = context.measureText(`${name}  `).width;
      context.fillStyle = colours.robots[k % colours.robots.length];
      if (x + wide < this.width - RIGHT) context.fillText(name, x, y);
      x += wide;
    });
  }

  /** A mark on the time axis where a contact of the run began. */
  drawContacts(context, colours, run) {
    const swept = run.array.whole("contact_swept");
    let last = -APART;
    run.array("contact_time").forEach((time, k) => {
      const x = this.x(time);
      if (x - last < APART) return;
      drawContact(context, x, this.height - AXIS, { swept: swept[k] === 1 }, colours, true);
      last = x;
    });
  }

  /** Names of the robots before their rows, where there is room. */
  nameRows(context, { names, marks }, frame, colours) {
    const high = frame.height / marks.length;
    if (high < TICK - 2) return;
    Object.assign(context, { textAlign: "right", textBaseline: "middle", fillStyle: colours.quiet });
    marks.forEach((mark, k) => {
      const room = 8 - mark.length;
      const name = names[k].length > room ? `${names[k].slice(0, room - 1)}…` : names[k];
      context.fillText(name + mark, LEFT - 5, frame.top + (k + 0.5) * high, LEFT - 8);
    });
  }

  drawTicks(context, frame, colours) {
    const [low, high] = frame.limits;
    const step = roundAbove(((high - low) * TICK) / frame.height);
    Object.assign(context, { textAlign: "right", textBaseline: "middle" });
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9; k++) {
      const y = frame.y(k * step);
      context.fillStyle = colours.quiet;
      context.fillText(tick(k * step, step), LEFT - 5, y);
      context.fillStyle = colours.rule;
      context.fillRect(frame.left, y - 0.5, frame.width, 1);
    }
  }

  drawAxis(context, colours) {
    const step = roundBelow((this.duration - this.begin) / Math.max(2, this.width / 130)) || 1;
    const first = Math.ceil(this.begin / step - 1e-9);
    context.fillStyle = colours.quiet;
    context.textBaseline = "alphabetic";
    for (let k = first; k * step <= this.duration + 1e-9; k++) {
      const x = this.x(k * step);
      context.textAlign = k === first ? "left" : x > this.width - RIGHT - 14 ? "right" : "center";
      const words = tick(k * step, step);
      context.fillText(k === first ? `${words} s` : words, x, this.height - 4);
    }
  }
}
