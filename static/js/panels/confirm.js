// Asking before something cannot be undone.

import { button, element } from "../dom.js";

/** Whether the user agrees to `question` by the button `consent`. */
export function confirmed(question, consent) {
  const dialog = element("dialog", { className: "confirm" }, element("p", {}, question));
  const answer = new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === consent);
    });
  });
  dialog.append(element("div", { className: "row" },
    button("Cancel", () => dialog.close("")),
    button(consent, () => dialog.close(consent), { className: "danger" })));
  document.body.append(dialog);
  dialog.showModal();
  return answer;
}
