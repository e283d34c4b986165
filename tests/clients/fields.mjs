// Hands for the fields of panels: each answers what to do with the field that a selector names.

/** Types a number into the input at `place` of those that the field has. */
export function number(place, value) {
  return async (page, field) => {
    const input = (await page.$$(`${field} input[type=number]`))[place];
    await input.click({ count: 3 });
    await page.keyboard.type(String(value));
    await page.keyboard.press("Enter");
  };
}

/** Chooses what has this label. */
export function choice(label) {
  return async (page, field) => {
    const value = await page.$eval(`${field} select`, (select, label) => [...select.options].find(({ text }) => text === label).value, label);
    await page.select(`${field} select`, value);
  };
}

/** Types a colour. */
export function color(hex) {
  return async (page, field) => {
    const input = await page.$(`${field} input.hex`);
    await input.click({ count: 3 });
    await page.keyboard.type(hex);
    await page.keyboard.press("Enter");
  };
}

/** Switches a check box. */
export function click() {
  return (page, field) => page.click(`${field} input[type=checkbox]`);
}

/** Moves a slider by a step of the arrow key. */
export function slide() {
  return (page, field) => page.focus(`${field} input[type=range]`).then(() => page.keyboard.press("ArrowRight"));
}

/** Drags the label of a number by so many pixels. */
export function scrub(pixels) {
  return (page, field) => dragBy(page, `${field} label`, pixels, 0);
}

/** Drags the ball of a direction. */
export function ball(dx, dy) {
  return (page, field) => dragBy(page, `${field} .ball`, dx, dy);
}

/** Turns the ball of a direction by an arrow key. */
export function turn(key) {
  return async (page, field) => {
    await page.focus(`${field} .ball`);
    await page.keyboard.press(key);
  };
}

async function dragBy(page, selector, dx, dy) {
  const handle = await page.$(selector);
  await handle.scrollIntoView();
  const { x, y, width, height } = await handle.boundingBox();
  const [left, top] = [x + width / 2, y + height / 2];
  await page.mouse.move(left, top);
  await page.mouse.down();
  await page.mouse.move(left + dx, top + dy, { steps: 4 });
  await page.mouse.up();
}
