// What can be taken home.

import * as api from '../api';
import { h } from '../dom';
import type { Display } from '../model/display';

export class Files {
  readonly element: HTMLElement;

  constructor(display: Display) {
    const { id, name } = display.file;
    const stem = name.split('.')[0] || 'model';
    const link = (text: string, what: () => [string, string]) => {
      const anchor = h('a', { href: '#', class: 'button', onclick: () => {
        const [path, file] = what();
        Object.assign(anchor, { href: `api/${path}`, download: file });
      } }, text);
      return anchor;
    };
    this.element = h('div', { class: 'downloads' },
      link('This level (GLB)', () => [api.levelPath(id, display.level), `${stem}_lod${display.level}.glb`]),
      link('All levels (GLB)', () => [`files/${id}/lods.glb`, `${stem}.glb`]),
      link('Numbers (JSON)', () => [`files/${id}`, `${stem}.report.json`]),
    );
  }
}
