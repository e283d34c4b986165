// Requests to the server, and its errors (RFC 9457) as one class.

/** What the server refused, or why it could not be asked. */
export class Problem extends Error {
  /**
   * @param {string} detail for people
   * @param {{title?: string, status?: number, errors?: {pointer?: string, parameter?: string, detail: string}[]}} more
   *   `status` is 0 when no answer came at all
   */
  constructor(detail, { title = detail, status = 0, errors = [] } = {}) {
    super(detail);
    Object.assign(this, { title, status, errors });
  }

  /** Whether the same request may succeed later: nobody answered, or the server had no time. */
  get isPassing() {
    return this.status === 0 || this.status === 503;
  }

  /** Of a problem document. */
  static from({ title, detail = title, status, errors }) {
    return new Problem(detail, { title, status, errors });
  }

  static async of(response) {
    try {
      return Problem.from({ status: response.status, ...(await response.json()) });
    } catch {
      return new Problem(`The server answered ${response.status} ${response.statusText}`, { status: response.status });
    }
  }
}

/** The successful response, or throws a {@link Problem}. A 304 is a success. */
export async function ask(path, options = {}) {
  let response;
  try {
    response = await fetch(path, options);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Problem("The server cannot be reached.");
  }
  if (!response.ok && response.status !== 304) throw await Problem.of(response);
  return response;
}

/** The JSON of a resource. */
export async function getJson(path, options) {
  return jsonOf(await ask(path, options));
}

/** Sends JSON and answers the JSON that comes back. */
export async function sendJson(method, path, value, headers = {}) {
  const options = { method, headers: { "Content-Type": "application/json", ...headers }, body: JSON.stringify(value) };
  return jsonOf(await ask(path, options));
}

/** The JSON that an answer holds. */
export async function jsonOf(response) {
  try {
    return await response.json();
  } catch {
    throw new Problem("The server's answer broke off.");
  }
}

/** The path of a scene, or of something under it: `scenePath("a", "files", "b.png")`. */
export function scenePath(id, ...parts) {
  return ["/scenes", id, ...parts].map((part, i) => (i === 0 ? part : encodeURIComponent(part))).join("/");
}
