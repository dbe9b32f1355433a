// The recording as the page holds it: one JSON document that refers into one packed block of arrays.

async function readDocument() {
  const text = document.getElementById("fotsmc-arrays").textContent.trim();
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const known = new Map();
  const resolve = (value) => {
    if (Array.isArray(value)) return value.map(resolve);
    if (value === null || typeof value !== "object") return value;
    if ("at" in value && "kind" in value) {
      if (!known.has(value.at)) known.set(value.at, unpack(bytes, value));
      return known.get(value.at);
    }
    return Object.fromEntries(Object.entries(value).map(([key, item]) => [key, resolve(item)]));
  };
  return resolve(JSON.parse(document.getElementById("fotsmc-document").textContent));
}

// Undoes what pack.py does: bytes of equal weight together, folded signs, differences.
function unpack(bytes, { at, count, kind }) {
  const width = kind === "u2" ? 2 : 4;
  const words = width === 2 ? new Int16Array(count) : new Int32Array(count);
  let last = 0;
  for (let i = 0; i < count; i++) {
    let folded = 0;
    for (let b = 0; b < width; b++) folded |= bytes[at + b * count + i] << (8 * b);
    last += (folded >>> 1) ^ -(folded & 1);
    words[i] = last;
    last = words[i];
  }
  if (kind === "f4") return new Float32Array(words.buffer);
  return width === 2 ? new Uint16Array(words.buffer) : new Uint32Array(words.buffer);
}

// Column `index` of an array that holds its columns one after the other, `rows` numbers each.
function column(array, index, rows) {
  return array.subarray(index * rows, (index + 1) * rows);
}

// The interval of the rising `times` that holds `t`: its first row and how far into it, 0 to 1.
function locate(times, t) {
  const last = times.length - 1;
  if (!(t > times[0])) return { row: 0, next: 0, part: 0 };
  if (t >= times[last]) return { row: last, next: last, part: 0 };
  let low = 0;
  let high = last;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle;
  }
  return { row: low, next: high, part: (t - times[low]) / (times[high] - times[low]) };
}

function interpolate(values, place) {
  return values[place.row] + place.part * (values[place.next] - values[place.row]);
}
