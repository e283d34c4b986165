// Actions that no field stands for, and what is said when they fail.

import { Problem } from "./server.js";

/** Does `action`; what the server has against it becomes a message under `title`. */
export async function tried(notices, title, action) {
  try {
    return await action();
  } catch (problem) {
    if (!(problem instanceof Problem)) throw problem;
    notices.show(problem, title);
  }
}
