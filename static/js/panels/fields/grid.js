// Rows of numbers: matrices and kernels.

import { field } from "../field.js";
import { element } from "../../dom.js";
import { setAt } from "../edit.js";
import { NumberControl } from "./number.js";

/** A field for an array of rows. `columns` names them for people who do not see the grid. */
export function gridField(scene, pointer, words, rows, columns) {
  let grid = [];
  const cells = rows.map((row, y) => columns.map((column, x) => {
    const cell = new NumberControl({ step: 0.05 }, (number) => {
      grid = grid.with(y, grid[y].with(x, number));
      setAt(scene, pointer, grid);
    });
    cell.inputs[0].setAttribute("aria-label", `${row}, ${column}`);
    return cell;
  }));
  const all = cells.flat();
  const table = element("div", { className: "grid" }, ...all.map((cell) => cell.element));
  table.style.setProperty("--columns", columns.length);
  return field(scene, pointer, words, {
    element: table,
    inputs: all.flatMap((cell) => cell.inputs),
    show: (value = []) => {
      grid = value;
      cells.forEach((line, y) => line.forEach((cell, x) => cell.show(value[y]?.[x])));
    },
  });
}
