// The server's own messages, as proto3 JSON.

/** What the server refuses: its reason, its words, and the fields at fault. */
export class Refused extends Error {
  constructor({ reason = "", message = "", fields = [] }) {
    super(message);
    Object.assign(this, { reason, fields });
  }
}

/** Calls a method, as "PlannerService/Plan". */
export async function call(method, request, signal) {
  const response = await post(method, request, signal);
  return response.json();
}

/** The same for a method that answers message by message. */
export async function callAll(method, request) {
  const text = await (await post(method, request)).text();
  return text.split("\n").filter(Boolean).map((line) => JSON.parse(line));
}

async function post(method, request, signal) {
  const response = await fetch(`api/motion.v1.${method}`, {
    method: "POST", signal, body: JSON.stringify(request),
    // No form of another site can send this one.
    headers: { "content-type": "application/json", "x-portamento": "console" },
  });
  if (response.ok) return response;
  let said;
  try {
    said = (await response.json()).error;
  } catch {
    said = { message: `the server answers ${response.status} ${response.statusText}` };
  }
  throw new Refused(said ?? {});
}

/** Looks on at streams: `names` with their columns, or summaries of all. Gives a way to end it. */
export function watch(names, options, { message, lost }) {
  const query = new URLSearchParams(options);
  names.forEach((name) => query.append("stream", name));
  const source = new EventSource(`api/motion.v1.SetpointService/WatchStream?${query}`);
  source.onmessage = ({ data }) => message(JSON.parse(data));
  source.addEventListener("refused", ({ data }) => message(null, new Refused(JSON.parse(data).error)));
  source.onerror = () => lost();
  return () => source.close();
}
