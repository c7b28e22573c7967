// Mouse and fingers on a view: drag moves, wheel and two fingers zoom, a click chooses.

const STILL = 6; // [px] that a click may move

export function listen(view, { time, redraw, choose }) {
  const { canvas, camera } = view;
  const fingers = new Map();
  let moved = 0;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return { middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], apart: Math.hypot(a[0] - b[0], a[1] - b[1]) };
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, place(event));
    if (fingers.size === 1) moved = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!fingers.has(event.pointerId)) {
      const { robot, contact } = view.under(place(event));
      canvas.style.cursor = robot === undefined && contact === undefined ? "grab" : "pointer";
      return;
    }
    const before = fingers.get(event.pointerId);
    const now = place(event);
    moved += Math.hypot(now[0] - before[0], now[1] - before[1]);
    if (fingers.size === 2) {
      const { middle, apart } = spread();
      fingers.set(event.pointerId, now);
      const after = spread();
      camera.pan(after.middle[0] - middle[0], after.middle[1] - middle[1], time());
      if (apart > 0) camera.zoomAt(after.apart / apart, after.middle, time());
      redraw(view);
      return;
    }
    fingers.set(event.pointerId, now);
    if (moved < STILL) return;
    camera.pan(now[0] - before[0], now[1] - before[1], time());
    redraw(view);
  });
  const up = (event) => {
    const was = fingers.delete(event.pointerId);
    if (was && event.type === "pointerup" && moved < STILL && fingers.size === 0) {
      choose(view, view.under(place(event)));
    }
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      camera.zoomAt(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), place(event), time());
      redraw(view);
    },
    { passive: false },
  );
}
