// What does not move: areas, obstacles, paths and walls, each made into a shape of metres once.

const THIN = 8; // [px/m] below which lines are thinner, as paths then lie close
const PATH_TINT = 0.58; // opacity of robots' own paths
const DASH = [5, 5]; // [px] of paths in the danger area
const DOTS = [3, 4]; // [px] of the ways of movers, which are bodies behind the robots

export class Ground {
  constructor(run) {
    const { scene } = run.header;
    // canvases compute with few digits: far from the origin of the world shapes need one of their own
    this.origin = [...scene.reference, ...scene.walls.flat(), [0, 0]][0];
    const shape = (lines, closed) => shapeOf(lines, closed, this.origin);
    this.areas = scene.areas.map(({ key, rings }) => ({ key, path: shape(rings, true) }));
    this.obstacles = shape(scene.obstacles, true);
    this.walls = shape(scene.walls, false);
    this.reference = shape([scene.reference], false);
    const dashed = scene.paths.some(({ danger }) => danger.length);
    this.paths = scene.paths.flatMap(({ robots, safe, danger }) => [
      { robot: robots.length > 1 ? -1 : robots[0], path: shape(safe, false), dash: robots[0] < run.robots ? [] : DOTS },
      ...(dashed ? [{ robot: robots.length > 1 ? -1 : robots[0], path: shape(danger, false), dash: DASH }] : []),
    ]);
  }

  /** Draws on a canvas whose pixels are those of `lens`. */
  draw(context, lens, colours) {
    context.save();
    this.place(context, lens);
    const pixel = 1 / lens.scale;
    for (const { key, path } of this.areas) {
      context.fillStyle = colours[key];
      context.fill(path, "evenodd");
    }
    context.fillStyle = colours.obstacle;
    context.fill(this.obstacles, "evenodd");
    context.lineJoin = "round";
    const thin = Math.min(1, lens.scale / THIN);
    this.stroke(context, this.reference, colours.reference, 2 * thin * pixel);
    for (const { robot, path, dash } of this.paths) {
      const own = dash === DOTS ? colours.way : colours.robots[robot % colours.robots.length];
      const colour = robot < 0 ? colours.band : own;
      context.globalAlpha = dash === DOTS ? 1 : PATH_TINT;
      context.setLineDash(dash.map((length) => length * pixel));
      this.stroke(context, path, colour, 1.2 * thin * pixel);
    }
    context.setLineDash([]);
    context.globalAlpha = 1;
    this.stroke(context, this.obstacles, colours.wall, pixel);
    this.stroke(context, this.walls, colours.wall, (1 + 2 * thin) * pixel);
    context.restore();
  }

  /** Draws what can be told apart when it is small. */
  drawPlain(context, lens, colours) {
    context.save();
    this.place(context, lens);
    const { key, path } = this.areas.at(-1) ?? { key: "floor", path: new Path2D() };
    context.fillStyle = colours[key];
    context.fill(this.areas[0]?.path ?? path, "evenodd");
    context.fillStyle = colours.obstacle;
    context.fill(this.obstacles, "evenodd");
    this.stroke(context, this.reference, colours.reference, 1 / lens.scale);
    this.stroke(context, this.walls, colours.wall, 1.3 / lens.scale);
    context.restore();
  }

  place(context, { scale, x, y }) {
    const [east, north] = this.origin;
    context.transform(scale, 0, 0, -scale, x + east * scale, y - north * scale);
  }

  stroke(context, path, colour, width) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke(path);
  }
}

/** Lines, or rings, of points [m], about an origin. */
function shapeOf(lines, closed, [east, north]) {
  const path = new Path2D();
  for (const line of lines) {
    line.forEach(([x, y], k) => (k ? path.lineTo(x - east, y - north) : path.moveTo(x - east, y - north)));
    if (closed) path.closePath();
  }
  return path;
}
