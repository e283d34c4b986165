// What is on the page follows the document of the open scene.

/** Calls `update(document)` now and at every change of the scene, for as long as `element` is on the page. */
export function follow(scene, element, update) {
  const onChange = () => {
    if (element.isConnected) return update(scene.document);
    scene.removeEventListener("open", onChange);
    scene.removeEventListener("change", onChange);
  };
  scene.addEventListener("open", onChange);
  scene.addEventListener("change", onChange);
  if (scene.document) update(scene.document);
}

/** `element`, which can be used once a scene is open: there is nothing to edit before. */
export function onceOpen(scene, element) {
  element.inert = scene.document === null;
  scene.addEventListener("open", () => { element.inert = false; }, { once: true });
  return element;
}

/**
 * An element whose content is built again when what `keyOf(document)` gives becomes another, and only then: fields
 * keep their focus through other changes. `refresh()` looks at the key out of turn.
 */
export function rebuilt(scene, element, keyOf, build) {
  let key;
  const update = (document) => {
    const next = JSON.stringify(keyOf(document) ?? null);
    if (next === key) return;
    key = next;
    element.replaceChildren(...build(document));
  };
  follow(scene, element, update);
  return { element, refresh: () => scene.document && update(scene.document) };
}
