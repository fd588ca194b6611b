// Places of models in the strip: a model's first child stands beside it, its others begin rows of their own.

/** [{ model, depth, row, parentRow }], parents before children. */
export function treeOf(models) {
  const children = new Map();
  for (const model of models) {
    const key = model.parent ?? null;
    if (!children.has(key)) children.set(key, []);
    children.get(key).push(model);
  }
  const placed = [];
  let rows = 0;
  const place = (model, depth, row, parentRow) => {
    placed.push({ model, depth, row, parentRow });
    (children.get(model.number) ?? []).forEach((child, k) => place(child, depth + 1, k === 0 ? row : (rows += 1), row));
  };
  for (const root of children.get(null) ?? []) {
    place(root, 0, rows, null);
    rows += 1;
  }
  return placed;
}
