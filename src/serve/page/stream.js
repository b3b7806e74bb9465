export async function get(path) {
  const response = await fetch(path);
  const json = await response.json();
  if (!response.ok) throw new Error(json.error);
  return json;
}

export async function post(path, body) {
  const response = await fetch(path, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
  });
  const json = await response.json();
  if (!response.ok) throw new Error(json.error);
  return json;
}

const lineEnds = new TextEncoder().encode("\r\n\r\n");

function find(bytes, wanted) {
  outer: for (let i = 0; i + wanted.length <= bytes.length; i++) {
    for (let k = 0; k < wanted.length; k++) if (bytes[i + k] !== wanted[k]) continue outer;
    return i;
  }
  return -1;
}

function join(a, b) {
  const both = new Uint8Array(a.length + b.length);
  both.set(a);
  both.set(b, a.length);
  return both;
}

// The pictures of a multipart stream as they come, each {number, blob}. Reading slowly makes the
// program send fewer.
export async function* pictures(path, signal) {
  const response = await fetch(path, { signal });
  if (!response.ok) throw new Error((await response.json()).error);
  const reader = response.body.getReader();
  let waiting = new Uint8Array(0);
  while (true) {
    const { value, done } = await reader.read();
    if (done) return;
    waiting = waiting.length ? join(waiting, value) : value;
    while (true) {
      const headEnd = find(waiting.subarray(0, 512), lineEnds);
      if (headEnd < 0) break;
      const head = new TextDecoder().decode(waiting.subarray(0, headEnd));
      const length = Number(/Content-Length: (\d+)/.exec(head)[1]);
      const begin = headEnd + lineEnds.length;
      if (waiting.length < begin + length + 2) break;
      const number = Number(/X-Frame: (\d+)/.exec(head)[1]);
      yield { number, blob: new Blob([waiting.subarray(begin, begin + length)], { type: "image/jpeg" }) };
      waiting = waiting.slice(begin + length + 2);
    }
  }
}
