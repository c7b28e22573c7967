// Numbers of a run from the text in which physim/drawing/page/packing.py has packed them.

/** Unpacks base64 of gzip: the header, and a function that gives an array by name. */
export async function unpack(text) {
  const packed = Uint8Array.from(atob(text.trim()), (sign) => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
  const planes = bytes.subarray(4 + length);
  const array = (name) => real(planes, header.arrays, name);
  array.whole = (name) => whole(planes, header.arrays[name]);
  array.has = (name) => Object.hasOwn(header.arrays, name);
  return { header, array };
}

/** Whole numbers: byte planes, zigzag, sums of differences. */
function whole(bytes, about) {
  const { at, n, planes, order } = about;
  if (at + n * planes > bytes.length) throw new RangeError("the data of this page are incomplete");
  const numbers = new Int32Array(n);
  for (let k = 0; k < n; k++) {
    let zigzag = 0;
    for (let plane = 0; plane < planes; plane++) zigzag |= bytes[at + plane * n + k] << (8 * plane);
    numbers[k] = (zigzag >>> 1) ^ -(zigzag & 1);
  }
  for (let round = 0; round < order; round++) {
    for (let k = 1; k < n; k++) numbers[k] = (numbers[k] + numbers[k - 1]) | 0;
  }
  return numbers;
}

const SPECIAL = [0, NaN, Infinity, -Infinity];

/** Floats whose bytes stand in planes, lowest first. */
function floats(bytes, { at, n }) {
  if (at + 8 * n > bytes.length) throw new RangeError("the data of this page are incomplete");
  const view = new DataView(new ArrayBuffer(8));
  return Float64Array.from({ length: n }, (_, k) => {
    for (let plane = 0; plane < 8; plane++) view.setUint8(plane, bytes[at + plane * n + k]);
    return view.getFloat64(0, true);
  });
}

/** Real numbers: so many times the quantum, and those that are not finite. */
function real(bytes, index, name) {
  if (!index[name].quantum) return floats(bytes, index[name]);
  const numbers = Float64Array.from(whole(bytes, index[name]));
  const { quantum, base = 0 } = index[name];
  for (let k = 0; k < numbers.length; k++) numbers[k] = (numbers[k] + base) * quantum;
  const kinds = index[`${name}?`];
  if (kinds) {
    whole(bytes, kinds).forEach((kind, k) => {
      if (kind) numbers[k] = SPECIAL[kind];
    });
  }
  return numbers;
}
