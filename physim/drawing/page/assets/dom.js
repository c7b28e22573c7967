// Elements of the page. Texts are only ever set as texts: nothing in a name is read as markup.

/** An element with attributes (functions are listeners) and children. */
export function el(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(name, value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

export const byId = (id) => document.getElementById(id);

/** Shows another text, and leaves the element alone where it is the same. */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function button(words, does, attributes = {}) {
  return el("button", { type: "button", click: does, ...attributes }, words);
}

/** A canvas as large as its box, in device pixels; true where it has changed. */
export function fitted(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { width, height } = canvas.getBoundingClientRect();
  const wide = Math.max(1, Math.round(width * ratio));
  const high = Math.max(1, Math.round(height * ratio));
  if (canvas.width === wide && canvas.height === high) return false;
  canvas.width = wide;
  canvas.height = high;
  return true;
}
