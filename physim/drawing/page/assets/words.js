// Numbers and names in words, as the video writes them (physim/drawing/labels.py).

export const decimal = (value, decimals) =>
  (Number(value.toFixed(decimals)) + 0).toFixed(decimals).replace("-", "\u2212");

/** Any number that a controller reports, with its unit; a distance has three decimals below 0.1 m. */
export function amount(value, unit) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "not reported" : "none";
  if (unit === "m") return `${decimal(value, Math.abs(value) < 0.0995 ? 3 : 2)} m`;
  if (unit === "s") return `${decimal(value, 2)} s`;
  return `${decimal(value, Number.isInteger(value) ? 0 : 3)} ${unit === "-" ? "" : unit}`.trim();
}

export const metres = (length) => amount(length, "m");

export const seconds = (time) => amount(time, "s");

export const command = ([v, omega, lateral]) =>
  `${decimal(v, 2)} m/s, ${decimal(omega, 2)} rad/s` + (lateral === undefined ? "" : `, ${decimal(lateral, 2)} m/s to the left`);

export const plural = (count, one, many = `${one}s`) => `${count} ${count === 1 ? one : many}`;

/** A round length at most `most`: 1, 2 or 5 times a power of ten. */
export function roundBelow(most) {
  const decade = 10 ** Math.floor(Math.log10(most));
  return decade * ([5, 2, 1].find((factor) => factor * decade <= most) ?? 1);
}

/** A round length of at least `least`. */
export function roundAbove(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  return decade * ([1, 2, 5].find((factor) => factor * decade >= least * (1 - 1e-9)) ?? 10);
}

/** A multiple of a round step, with as many decimals as the step needs. */
export const multiple = (value, step) =>
  decimal(value, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));

const LONGEST_TICK = 6; // characters that stand beside a plot

/** A tick, with as many decimals as the step between ticks needs; long ones with an exponent. */
export function tick(value, step) {
  const plain = multiple(value, step);
  if (plain.length <= LONGEST_TICK || !value) return plain;
  return Number(value.toPrecision(3)).toExponential().replace("e+", "e").replaceAll("-", "\u2212");
}
