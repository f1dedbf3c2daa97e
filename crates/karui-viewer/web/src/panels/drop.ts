// Files dragged onto the page.

import { h } from '../dom';

/** Calls with each file that is dropped anywhere on `root`. */
export function dropping(root: HTMLElement, take: (file: File) => void): void {
  const veil = h('div', { class: 'veil', hidden: true }, h('p', {}, 'Drop a model: OBJ, PLY, STL, OFF (also .gz), GLB'));
  root.append(veil);
  const carries = (event: DragEvent) => event.dataTransfer?.types.includes('Files') ?? false;
  addEventListener('dragover', (event) => {
    if (!carries(event)) return;
    event.preventDefault();
    veil.hidden = false;
  });
  addEventListener('dragleave', (event) => {
    if (!event.relatedTarget) veil.hidden = true;
  });
  addEventListener('drop', (event) => {
    veil.hidden = true;
    if (!carries(event)) return;
    event.preventDefault();
    for (const file of event.dataTransfer?.files ?? []) take(file);
  });
}
