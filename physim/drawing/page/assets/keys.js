// Keys: what they do is told in the page, under "keys".

export const KEYS = [
  ["space", "play or pause"],
  ["← →", "0.1 s back, on; with Shift 1 s"],
  ["Home End", "start, end"],
  ["[ ]", "slower, faster"],
  ["+ −", "zoom in, zoom out"],
  ["0", "reset the view"],
  ["n p", "next, previous robot"],
  ["f", "follow the chosen robot"],
  ["Esc", "clear the choice"],
];

export function listenToKeys(does) {
  const actions = {
    " ": () => does.toggle(),
    ArrowLeft: (event) => does.step(event.shiftKey ? -1 : -0.1),
    ArrowRight: (event) => does.step(event.shiftKey ? 1 : 0.1),
    Home: () => does.seek(0),
    End: () => does.seek(Infinity),
    "[": () => does.faster(-1),
    "]": () => does.faster(1),
    "+": () => does.zoom(1.25),
    "=": () => does.zoom(1.25),
    "-": () => does.zoom(0.8),
    0: () => does.look(),
    n: () => does.next(1),
    p: () => does.next(-1),
    f: () => does.follow(),
    Escape: () => does.choose(),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event;
    if (target.closest("select, textarea, input:not([type=range], [type=checkbox])")) return;
    if (event.key === " " && target.closest("button, summary, a, input, label")) return;
    const action = Object.hasOwn(actions, event.key) ? actions[event.key] : null;
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}
