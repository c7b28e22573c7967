// The address of a moment: #t=82.2&robot=r6, read and written.

/** What an address asks for: time [s], robot and run by number, contact; what is not there is absent. */
export function readHash(hash, runs) {
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const found = {};
  const run = Number(given.get("run") ?? 1) - 1;
  found.run = Number.isInteger(run) && runs[run] ? run : 0;
  const time = Number(given.get("t"));
  if (given.has("t") && Number.isFinite(time)) found.time = time;
  if (given.has("robot")) {
    const { names, robots } = runs[found.run];
    const robot = names.slice(0, robots).indexOf(given.get("robot"));
    if (robot >= 0) found.robot = robot;
  }
  const contact = Number(given.get("contact")) - 1;
  const { count } = runs[found.run].header.contacts;
  if (given.has("contact") && Number.isInteger(contact) && contact >= 0 && contact < count) {
    found.contact = contact;
  }
  return found;
}

export function writeHash({ time, run, robot, contact }, runs) {
  const said = new URLSearchParams();
  said.set("t", String(Number(time.toFixed(3))));
  if (runs.length > 1) said.set("run", String(run + 1));
  if (robot >= 0) said.set("robot", runs[run].names[robot]);
  if (contact >= 0) said.set("contact", String(contact + 1));
  return `#${said}`;
}
