// How surfaces are shown, and what they are compared with.

import { check, Choice, h } from '../dom';
import type { Host } from '../mode';
import type { Display } from '../model/display';
import type { Compare, Look } from '../state';

export class LookPanel {
  readonly element: HTMLElement;
  private readonly look: Choice<Look>;
  private readonly compare: Choice<Compare>;
  private readonly flat: HTMLInputElement;
  private readonly wire: HTMLInputElement;

  constructor(
    private readonly host: Host,
    display: Display,
  ) {
    const { store } = host;
    const looks = [['material', 'Material'], ['clay', 'Clay'], ['normals', 'Normals'], ['uv', 'UV']] as const;
    this.look = new Choice('Surface', looks, (look) => store.set({ look, heat: '' }));
    const ways = [['off', 'Alone'], ['side', 'Beside original'], ['wipe', 'Wipe']] as const;
    this.compare = new Choice('Compare', ways, (compare) => store.set({ compare }));
    const [wire, wireBox] = check('Edges', 'W', (on) => store.set({ wire: on }));
    const [flat, flatBox] = check('Flat', 'F', (on) => store.set({ flat: on }));
    [this.wire, this.flat] = [wireBox, flatBox];
    const uv = display.file.attributes.some((a) => a.startsWith('uv'));
    this.look.enable('uv', uv, 'The model has no texture coordinates');
    this.element = h('div', {}, this.look.element, this.compare.element, h('div', { class: 'pair' }, wire, flat));
  }

  refresh(): void {
    const { look, compare, flat, wire } = this.host.store.state;
    this.look.set(look);
    this.compare.set(compare);
    [this.flat.checked, this.wire.checked] = [flat, wire];
  }
}
